import { describe, expect, it } from "vitest";

import type { BlobsMessage, HypothesesMessage } from "../live/messages";
import { blobItems, followed, hypothesisItems, itemAt } from "./found";

const hypotheses = {
  topic: "overlay/hypotheses",
  now_s: 2,
  grabbed_s: 1,
  frame: 30,
  content: {
    count: 2,
    shown: [
      { what: "blue robot", id: 3, is_accepted: true, x_px: 100, y_px: 100, radius_px: 18, box_px: [95, 95, 105, 105], confidence: 0.9, gate: "", found: "", accepted: "" },
      { what: "ball", id: null, is_accepted: false, x_px: 200, y_px: 100, radius_px: 5, box_px: [188, 88, 212, 112], confidence: 0.2, gate: "too large (ball.max_area)", found: "circle 24 px across", accepted: "9 to 18 px" },
    ],
  },
} as HypothesesMessage;
const blobs = { topic: "overlay/blobs", now_s: 2, grabbed_s: 1, frame: 30, content: { count: 1, shown: [{ color: "orange", x_px: 200, y_px: 100, area_px: 450, box_px: [190, 90, 210, 110] }] } } as BlobsMessage;

describe("items of an overlay", () => {
  it("say why something is rejected", () => {
    const [robot, ball] = hypothesisItems(hypotheses);
    expect([robot!.kind, robot!.title, robot!.why]).toEqual(["accepted", "blue robot, marker 3", ""]);
    expect(ball!.why).toBe("too large (ball.max_area): circle 24 px across; accepted: 9 to 18 px");
  });

  it("are found by their place, the smallest first", () => {
    const items = [...hypothesisItems(hypotheses), ...blobItems(blobs)];
    expect(itemAt(items, 201, 101)?.kind).toBe("blob");
    expect(itemAt(items, 185, 88)?.title).toBe("ball");
    expect(itemAt(items, 400, 300)).toBeNull();
  });

  it("are followed from overlay to overlay", () => {
    const [robot] = hypothesisItems(hypotheses);
    const moved = { ...robot!, x: 110, y: 96 };
    const rival = { ...robot!, title: "blue robot, marker 4", x: 101, y: 100 };
    expect(followed([rival, moved], robot!)).toBe(moved);
    expect(followed([{ ...robot!, x: 160 }], robot!)).toBeNull();
    expect(followed([moved], null)).toBeNull();
  });
});
