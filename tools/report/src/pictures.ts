// Pictures of cameras, decoded on demand; the most recent ones are kept.
import { bytes_of } from './blobs';
import type { BlobReference, CameraEntry, PictureEntry } from './format';

const most_kept = 96;
const kept = new Map<string, Promise<ImageBitmap>>();

export function picture_of(blob: BlobReference): Promise<ImageBitmap> {
  let picture = kept.get(blob.id);
  if (picture) kept.delete(blob.id);
  else
    picture = bytes_of(blob).then((bytes) =>
      createImageBitmap(new Blob([bytes], { type: blob.media_type ?? 'image/png' })),
    );
  kept.set(blob.id, picture);
  if (kept.size > most_kept) kept.delete(kept.keys().next().value!);
  return picture;
}

export interface Shown {
  entry: PictureEntry;
  expected: BlobReference | null;
  actual: BlobReference | null;
  expected_tick: number | null;
  actual_tick: number | null;
}

/** What each run's camera shows at that tick: its last picture until then. */
export function shown_at(camera: CameraEntry, tick: number): Shown | null {
  const { pictures } = camera;
  let low = 0,
    high = pictures.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (pictures[middle]!.tick <= tick) low = middle + 1;
    else high = middle;
  }
  const entry = pictures[low - 1];
  if (!entry) return null;
  const shown: Shown = { entry, expected: null, actual: null, expected_tick: null, actual_tick: null };
  for (let i = low - 1; i >= 0 && (!shown.expected || !shown.actual) && i > low - 1 - 1000; --i) {
    const picture = pictures[i]!;
    if (!shown.actual && picture.actual) ((shown.actual = picture.actual), (shown.actual_tick = picture.tick));
    const golden = picture.golden === 'same' ? picture.actual : picture.golden;
    if (!shown.expected && golden) ((shown.expected = golden), (shown.expected_tick = picture.tick));
  }
  return shown;
}

/** |actual - expected| of each colour, times gain. */
export function draw_difference(
  into: CanvasRenderingContext2D,
  expected: ImageBitmap,
  actual: ImageBitmap,
  gain: number,
) {
  const width = Math.min(expected.width, actual.width),
    height = Math.min(expected.height, actual.height);
  const pixels_of = (picture: ImageBitmap) => {
    const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })!;
    context.drawImage(picture, 0, 0);
    return context.getImageData(0, 0, width, height);
  };
  const result = pixels_of(actual),
    other = pixels_of(expected);
  const a = result.data,
    b = other.data;
  for (let i = 0; i < a.length; i += 4) {
    a[i] = Math.abs(a[i]! - b[i]!) * gain;
    a[i + 1] = Math.abs(a[i + 1]! - b[i + 1]!) * gain;
    a[i + 2] = Math.abs(a[i + 2]! - b[i + 2]!) * gain;
    a[i + 3] = 255;
  }
  into.putImageData(result, 0, 0);
}
