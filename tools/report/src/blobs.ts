// Blobs: elements of the page, decoded on demand.
import type { BlobReference, ConstantArray, NumberArray, NumberType } from './format';

export type Numbers = Float64Array | Float32Array | BigInt64Array | BigUint64Array | Uint32Array | Uint8Array;

const widths = { f64: 8, f32: 4, i64: 8, u64: 8, u32: 4, u8: 1 };

// An element is complete after the browser has read something behind it.
function whole_element(id: string): Element | null {
  const element = document.getElementById(id);
  return element && (element.nextElementSibling || document.readyState !== 'loading') ? element : null;
}

const page_read = new Promise<void>((resolve) => {
  if (document.readyState !== 'loading') resolve();
  else document.addEventListener('DOMContentLoaded', () => resolve());
});

/** The text of an element, which the browser may not have read yet. */
export async function text_of(id: string): Promise<string | null> {
  const there = whole_element(id);
  if (there) return there.textContent;
  if (document.readyState === 'loading') {
    await new Promise<void>((resolve) => {
      const observer = new MutationObserver(() => {
        if (!whole_element(id)) return;
        observer.disconnect();
        resolve();
      });
      observer.observe(document.documentElement, { childList: true, subtree: true });
      void page_read.then(() => (observer.disconnect(), resolve()));
    });
  }
  return document.getElementById(id)?.textContent ?? null;
}

type Base64Decoder = { fromBase64?(text: string): Uint8Array<ArrayBuffer> };

function from_base64(text: string): Uint8Array<ArrayBuffer> {
  const decoder = Uint8Array as unknown as Base64Decoder;
  if (decoder.fromBase64) return decoder.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** A blob's bytes. An error if the page hasn't got them, or not as many as it says. */
export async function bytes_of(blob: BlobReference): Promise<Uint8Array<ArrayBuffer>> {
  const text = await text_of(blob.id);
  if (text === null) throw new Error(`blob ${blob.id} is missing; was the file cut off?`);
  let bytes = from_base64(text);
  if (blob.coding === 'deflate') {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
    bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  }
  if (bytes.length !== blob.bytes) throw new Error(`blob ${blob.id} has ${bytes.length} bytes, not ${blob.bytes}`);
  return bytes;
}

/** The JSON that a blob contains. */
export async function json_of(blob: BlobReference): Promise<unknown> {
  return JSON.parse(new TextDecoder().decode(await bytes_of(blob)));
}

// Reverses the filter `columns`: the first bytes of all elements, then the second bytes, ... become elements.
function put_columns_back(columns: Uint8Array, width: number): Uint8Array<ArrayBuffer> {
  const count = columns.length / width;
  const bytes = new Uint8Array(columns.length);
  for (let column = 0; column < width; ++column) {
    const from = column * count;
    for (let i = 0, to = column; i < count; ++i, to += width) bytes[to] = columns[from + i]!;
  }
  return bytes;
}

function xor_with_previous(bytes: Uint8Array, width: number) {
  for (let i = width; i < bytes.length; ++i) bytes[i]! ^= bytes[i - width]!;
}

// Elements beyond the end of the base stay unchanged.
function xor_with(bytes: Uint8Array, base: Uint8Array) {
  const end = Math.min(bytes.length, base.length);
  for (let i = 0; i < end; ++i) bytes[i]! ^= base[i]!;
}

function as_numbers(bytes: Uint8Array<ArrayBuffer>, type: NumberType): Numbers {
  const { buffer } = bytes;
  switch (type) {
    case 'f64':
      return new Float64Array(buffer);
    case 'f32':
      return new Float32Array(buffer);
    case 'i64':
      return new BigInt64Array(buffer);
    case 'u64':
      return new BigUint64Array(buffer);
    case 'u32':
      return new Uint32Array(buffer);
    case 'u8':
      return bytes;
  }
}

function repeated({ type, count, constant }: ConstantArray): Numbers {
  const numbers = as_numbers(new Uint8Array(count * widths[type]), type);
  if (numbers instanceof BigInt64Array || numbers instanceof BigUint64Array) numbers.fill(BigInt(constant));
  else numbers.fill(Number(constant));
  return numbers;
}

/** An array of numbers; `base` are those of the series that one with the filter `xor-base` belongs to. */
export async function numbers_of(array: NumberArray, base?: Numbers): Promise<Numbers> {
  if ('constant' in array) return repeated(array);
  const width = widths[array.type];
  if (array.bytes % width !== 0 || array.bytes < array.count * width)
    throw new Error(`blob ${array.id}: ${array.bytes} bytes for ${array.count} of ${array.type}`);
  let bytes = await bytes_of(array);
  if (array.filter !== 'none') bytes = put_columns_back(bytes, width);
  if (array.filter === 'xor') xor_with_previous(bytes, width);
  if (array.filter === 'xor-base') {
    if (!base) throw new Error(`blob ${array.id}: the values that it is the difference to are missing`);
    xor_with(bytes, new Uint8Array(base.buffer as ArrayBuffer));
  }
  // the blob may contain a longer array
  return as_numbers(bytes, array.type).subarray(0, array.count);
}

/** Of an array whose numbers are small enough for a double: all but large 64-bit integers, which are rounded. */
export function as_doubles(numbers: Numbers): Exclude<Numbers, BigInt64Array | BigUint64Array> {
  if (!(numbers instanceof BigInt64Array || numbers instanceof BigUint64Array)) return numbers;
  const doubles = new Float64Array(numbers.length);
  for (let i = 0; i < numbers.length; ++i) doubles[i] = Number(numbers[i]);
  return doubles;
}
