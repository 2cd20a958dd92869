import { describe, expect, it, vi } from "vitest";

import type { PictureMessage } from "../live/messages";
import { KEPT, Pictures } from "./pictures";

const picture = (number: number): PictureMessage => ({ topic: "picture", number, grabbed_s: number / 15, bitmap: { close: vi.fn() } as unknown as ImageBitmap });

describe("the last pictures", () => {
  it("have the one of an overlay", () => {
    const pictures = new Pictures();
    for (let number = 1; number <= 6; number += 1) pictures.add(picture(number));
    expect(pictures.newest?.number).toBe(6);
    expect(pictures.of(3.1 / 15)?.number).toBe(3);
    expect(pictures.of(30)).toBeNull();
  });

  it("are closed when they are dropped", () => {
    const pictures = new Pictures();
    const first = picture(1);
    pictures.add(first);
    for (let number = 2; number <= KEPT; number += 1) pictures.add(picture(number));
    expect(first.bitmap.close).not.toHaveBeenCalled();
    pictures.add(picture(KEPT + 1));
    expect(first.bitmap.close).toHaveBeenCalledOnce();
    pictures.clear();
    expect(pictures.newest).toBeNull();
  });
});
