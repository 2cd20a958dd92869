import { describe, expect, it } from "vitest";

import type { Alarm, Status } from "../api/types";
import { figuresOf, identity, levelOf } from "./strip";

const SLOW: Alarm = { level: "warning", about: "camera", text: "9.0 of 30 pictures", advice: "Give light.", detail: "", first_s: 9, since_s: 4 };
const BLIND: Alarm = { ...SLOW, level: "error", text: "no image yet" };

function status(changes: Partial<Status> = {}): Status {
  return {
    alarms: [], cameras: [{ measured_rate_hz: 30, age_s: 0.012 }], clients: [{}, {}], waiting: [],
    lags: { server: { median_ms: 12.4, max_ms: 20 }, network: null, client: null, shutter_delay_ms: 0 },
    losses: { missed: {}, overruns: {}, dropped: {} }, selftest: { grade: "A", policy: "FIFO 50" },
    ...changes,
  } as unknown as Status;
}
const figure = (key: string, of: Status) => figuresOf(of).find((each) => each.key === key);

describe("the health strip", () => {
  it("takes the worst alarm about a figure as its state", () => {
    expect(levelOf([], "camera")).toBe("ok");
    expect(levelOf([SLOW], "camera")).toBe("warning");
    expect(levelOf([SLOW, BLIND], "camera")).toBe("error");
    expect(levelOf([SLOW, BLIND], "lag")).toBe("ok");
    expect(figure("camera", status({ alarms: [BLIND] }))).toMatchObject({ level: "error", word: "no image" });
  });

  it("adds what tasks missed and what took too long", () => {
    const losses = { missed: { perceive: 3 }, overruns: { perceive: 1, serve: 2 }, dropped: { "blue 3": 7 } };
    expect(figure("misses", status({ losses }))).toMatchObject({ value: "6" });
    expect(figure("misses", status({ losses }))?.title).toContain("perceive 4, serve 2");
    expect(figure("drops", status({ losses }))).toMatchObject({ value: "7" });
  });

  it("calls for the referee when somebody waits", () => {
    expect(figure("clients", status())).toMatchObject({ value: "2 / 0", level: "ok" });
    const waiting = [{}] as Status["waiting"];
    expect(figure("clients", status({ waiting }))).toMatchObject({ value: "2 / 1", level: "warning", word: "1 waiting" });
  });

  it("shows a dash for what nobody reports", () => {
    expect(figure("lag", status())?.value).toBe("12 · – · –");
  });

  it("knows an alarm again when its numbers have changed", () => {
    expect(identity(SLOW)).toBe(identity({ ...SLOW, text: "8.75 of 30 pictures" }));
    expect(identity(SLOW)).not.toBe(identity(BLIND));
  });
});
