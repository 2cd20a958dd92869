import { describe, expect, it } from "vitest";

import { ballWords } from "./ball";

const blue3 = { team: "blue" as const, id: 3 };
const nameless = { team: "yellow" as const, id: null };

describe("ballWords", () => {
  it("says that nothing was checked", () => {
    expect(ballWords(null)).toBe("not checked yet");
  });
  it("names the robots that hide the ball", () => {
    expect(ballWords({ age_s: 0, ball: "may be hidden", hiding: [blue3, nameless], can_hide_ball: [] })).toBe("may be hidden behind blue marker 3, a yellow robot");
  });
  it("says where a ball that is gone may be", () => {
    expect(ballWords({ age_s: 0, ball: "gone", hiding: [], can_hide_ball: [blue3] })).toContain("it may be behind blue marker 3");
    expect(ballWords({ age_s: 0, ball: "gone", hiding: [], can_hide_ball: [] })).toBe("gone: nothing covers the place where it was last");
  });
  it("has the other states in words", () => {
    expect(ballWords({ age_s: 0, ball: "seen", hiding: [], can_hide_ball: [] })).toBe("seen");
    expect(ballWords({ age_s: 0, ball: "unknown", hiding: [], can_hide_ball: [] })).toBe("not seen yet");
  });
});
