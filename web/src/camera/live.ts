// What the camera page shows: the newest picture, or the one to which the overlay belongs, or a frozen one.

import { computed, onScopeDispose, ref, shallowRef, watch, type ComputedRef, type Ref, type ShallowRef } from "vue";

import type { BlobsMessage, BoundaryMessage, ClassesMessage, ContoursMessage, HypothesesMessage, LinesMessage, PictureMessage, SightingsMessage } from "../live/messages";
import { useTopic, useTopicWhile } from "../live/service";
import { rasterOf, type ClassRaster } from "./classes";
import type { Shown } from "./draw";
import { blobItems, hypothesisItems, lineItems, type Item, type Kind } from "./found";
import { layers } from "./layers";
import { Pictures } from "./pictures";

export interface CameraLive {
  picture: ShallowRef<PictureMessage | null>;
  /** Frame and instant of the overlay; null: none is shown. */
  overlayOf: ComputedRef<{ frame: number; grabbed_s: number } | null>;
  isOverlayOld: ComputedRef<boolean>;
  isFrozen: Ref<boolean>;
  shown: ComputedRef<Omit<Shown, "chosen" | "masks"> | null>;
  items: ComputedRef<Item[]>;
  /** How many of a kind there are, shown or not. */
  counts: ComputedRef<Partial<Record<Kind, number>>>;
  legend: ComputedRef<{ name: string; bgr: [number, number, number] }[]>;
}

/** One overlay: the messages of all layers, as they come from one image after the other. */
function useOverlay() {
  const wantsHypotheses = () => layers.rejected || (layers.robots && (layers.blobs || layers.classes));
  const hypotheses = useTopicWhile<HypothesesMessage>("overlay/hypotheses", wantsHypotheses);
  const blobs = useTopicWhile<BlobsMessage>("overlay/blobs", () => layers.blobs);
  const classes = useTopicWhile<ClassesMessage>("overlay/classes", () => layers.classes);
  const lines = useTopicWhile<LinesMessage>("overlay/lines", () => layers.lines);
  const boundary = useTopicWhile<BoundaryMessage>("overlay/boundary", () => layers.boundary);
  const contours = useTopicWhile<ContoursMessage>("overlay/contours", () => layers.contours);
  const raster = shallowRef<ClassRaster | null>(null);
  watch(classes, async (message) => {
    const made = message && (await rasterOf(message));
    if (classes.value === message) raster.value = made;
  });
  return computed(() => ({ hypotheses: hypotheses.value, blobs: blobs.value, classes: classes.value, raster: raster.value, lines: lines.value, boundary: boundary.value, contours: contours.value }));
}

export function useCameraLive(): CameraLive {
  const pictures = new Pictures();
  const incoming = useTopic<PictureMessage>("picture");
  const sightings = useTopic<SightingsMessage>("sightings");
  const overlay = useOverlay();
  const isFrozen = ref(false);
  const newest = shallowRef<PictureMessage | null>(null);
  const now = computed(() => ({ overlay: overlay.value, seen: sightings.value }));
  const kept = shallowRef(now.value); // what a frozen picture shows
  watch(now, (value) => {
    if (!isFrozen.value) kept.value = value;
  });
  watch(isFrozen, () => (kept.value = now.value));
  watch(incoming, (message) => {
    if (!message) return;
    if (isFrozen.value) return message.bitmap.close();
    pictures.add(message);
    newest.value = message;
  });
  onScopeDispose(() => pictures.clear());

  const messages = computed(() => {
    const { hypotheses, blobs, classes, lines, boundary, contours } = kept.value.overlay;
    return [hypotheses, blobs, classes, lines, boundary, contours].filter((message) => message !== null);
  });
  const overlayOf = computed(() => messages.value.reduce<{ frame: number; grabbed_s: number } | null>((old, one) => (old === null || one.grabbed_s < old.grabbed_s ? one : old), null));
  const picture = shallowRef<PictureMessage | null>(null);
  const isOverlayOld = computed(() => overlayOf.value !== null && newest.value !== null && overlayOf.value.grabbed_s < newest.value.grabbed_s && pictures.of(overlayOf.value.grabbed_s) === null);
  watch([newest, overlayOf], () => {
    picture.value = (overlayOf.value && pictures.of(overlayOf.value.grabbed_s)) ?? pictures.newest;
  });

  const shown = computed(() => {
    if (!picture.value) return null;
    const { hypotheses, blobs, raster, lines, boundary, contours } = kept.value.overlay;
    const drawn = { hypotheses, blobs, classes: raster, lines, boundary, contours };
    return { bitmap: picture.value.bitmap, seen: kept.value.seen, overlay: drawn, isOverlayOld: isOverlayOld.value, show: { ...layers } };
  });
  const items = computed(() => {
    const { hypotheses, blobs, lines } = kept.value.overlay;
    return [...(layers.rejected ? hypothesisItems(hypotheses) : []), ...blobItems(blobs), ...lineItems(lines)];
  });
  const counts = computed(() => {
    const { hypotheses, blobs, lines } = kept.value.overlay;
    const found: Partial<Record<Kind, number>> = {};
    if (layers.rejected && hypotheses) {
      found.accepted = items.value.filter(({ kind }) => kind === "accepted").length;
      found.rejected = hypotheses.content.count - found.accepted;
    }
    if (blobs) found.blob = blobs.content.count;
    if (lines) found.line = lines.content.length;
    return found;
  });
  const legend = computed(() => kept.value.overlay.classes?.content.colors ?? []);
  return { picture, overlayOf, isOverlayOld, isFrozen, shown, items, counts, legend };
}
