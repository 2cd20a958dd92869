// The picture of color classes, in the colors of the classes.

import type { ClassesMessage } from "../live/messages";

export interface ClassRaster {
  canvas: OffscreenCanvas;
  /** Pixels of the camera's picture per pixel of the raster. */
  step: number;
}

/** Decode a message; null when the picture is damaged. */
export async function rasterOf(message: ClassesMessage): Promise<ClassRaster | null> {
  const { png, step_px, colors } = message.content;
  const bytes = Uint8Array.from(atob(png), (letter) => letter.charCodeAt(0));
  let bitmap: ImageBitmap;
  try {
    bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
  } catch {
    return null;
  }
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const pen = canvas.getContext("2d", { willReadFrequently: true })!;
  pen.drawImage(bitmap, 0, 0);
  bitmap.close();
  const image = pen.getImageData(0, 0, canvas.width, canvas.height);
  paint(image.data, colors.map(({ bgr }) => bgr));
  pen.putImageData(image, 0, 0);
  return { canvas, step: step_px };
}

/** Replace numbers of classes in RGBA pixels by the classes' colors; pixels of no class become transparent. */
export function paint(rgba: Uint8ClampedArray, colors: readonly (readonly [number, number, number])[]): void {
  for (let at = 0; at < rgba.length; at += 4) {
    const [blue, green, red] = colors[rgba[at]! - 1] ?? [0, 0, 0];
    const isClass = rgba[at]! > 0;
    rgba.set([red, green, blue, isClass ? 255 : 0], at);
  }
}
