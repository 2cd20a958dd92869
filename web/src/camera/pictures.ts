// The last pictures of the camera: an overlay comes later than its picture, and is drawn on that one.

import type { PictureMessage } from "../live/messages";

export const KEPT = 12; // at 15 pictures a second, and four overlays
export const SAME_S = 0.1; // a picture grabbed so near to an overlay's is taken for its own

export class Pictures {
  private kept: PictureMessage[] = [];

  add(picture: PictureMessage): void {
    this.kept.push(picture);
    while (this.kept.length > KEPT) this.kept.shift()!.bitmap.close();
  }

  get newest(): PictureMessage | null {
    return this.kept.at(-1) ?? null;
  }

  /** The picture grabbed nearest to an instant; null: none within SAME_S. */
  of(grabbed_s: number): PictureMessage | null {
    const away = (picture: PictureMessage) => Math.abs(picture.grabbed_s - grabbed_s);
    const best = this.kept.reduce<PictureMessage | null>((near, picture) => (near === null || away(picture) < away(near) ? picture : near), null);
    return best && away(best) <= SAME_S ? best : null;
  }

  clear(): void {
    for (const picture of this.kept.splice(0)) picture.bitmap.close();
  }
}
