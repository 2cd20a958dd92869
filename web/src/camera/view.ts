// Which part of a picture is shown: zoom and place, in the units of the canvas.

export const MAX_ZOOM = 16;
export const STEP = 1.25;

export interface Size {
  width: number;
  height: number;
}

/** zoom 1 fits the picture; x, y: the picture's left upper corner on the canvas [CSS px]. */
export interface View {
  zoom: number;
  x: number;
  y: number;
}

/** Canvas pixels per picture pixel. */
export function scaleOf(view: View, canvas: Size, picture: Size): number {
  return view.zoom * Math.min(canvas.width / picture.width, canvas.height / picture.height);
}

/** The whole picture, in the middle. */
export function fitted(canvas: Size, picture: Size): View {
  return clamped({ zoom: 1, x: 0, y: 0 }, canvas, picture);
}

/** The view with limits of its zoom; the picture never leaves the canvas, and is in its middle where it is smaller. */
export function clamped(view: View, canvas: Size, picture: Size): View {
  const zoom = Math.min(Math.max(view.zoom, 1), MAX_ZOOM);
  const scale = scaleOf({ ...view, zoom }, canvas, picture);
  const kept = (at: number, room: number, size: number) => (size <= room ? (room - size) / 2 : Math.min(Math.max(at, room - size), 0));
  return { zoom, x: kept(view.x, canvas.width, picture.width * scale), y: kept(view.y, canvas.height, picture.height * scale) };
}

/** Zoom by a factor; the point of the picture at x, y of the canvas stays there. */
export function zoomed(view: View, factor: number, x: number, y: number, canvas: Size, picture: Size): View {
  const zoom = Math.min(Math.max(view.zoom * factor, 1), MAX_ZOOM);
  const grown = zoom / view.zoom;
  return clamped({ zoom, x: x - (x - view.x) * grown, y: y - (y - view.y) * grown }, canvas, picture);
}

export function panned(view: View, dx: number, dy: number, canvas: Size, picture: Size): View {
  return clamped({ ...view, x: view.x + dx, y: view.y + dy }, canvas, picture);
}

/** The pixel of the picture at a place of the canvas. */
export function pixelAt(view: View, x: number, y: number, canvas: Size, picture: Size): [number, number] {
  const scale = scaleOf(view, canvas, picture);
  return [(x - view.x) / scale, (y - view.y) / scale];
}
