// Writes blobs according to tools/report/FORMAT.md alone, so that page and harness are tested against the description.
import { deflateSync } from 'node:zlib';

const arrays = {
  f64: Float64Array,
  f32: Float32Array,
  i64: BigInt64Array,
  u64: BigUint64Array,
  u32: Uint32Array,
  u8: Uint8Array,
};

function bytes_of(numbers) {
  return new Uint8Array(numbers.buffer, numbers.byteOffset, numbers.byteLength);
}

function in_columns(bytes, width) {
  const columns = new Uint8Array(bytes.length),
    count = bytes.length / width;
  for (let i = 0; i < count; ++i)
    for (let byte = 0; byte < width; ++byte) columns[byte * count + i] = bytes[i * width + byte];
  return columns;
}

export class BlobWriter {
  elements = [];

  #add(bytes, more) {
    const id = `b${this.elements.length}`;
    this.elements.push(`<script type="text/plain" id="${id}">${Buffer.from(bytes).toString('base64')}</script>`);
    return { id, ...more };
  }

  picture(png) {
    return this.#add(png, { bytes: png.length, coding: 'none', media_type: 'image/png' });
  }

  text(text, more) {
    const bytes = Buffer.from(text, 'utf8');
    return this.#add(deflateSync(bytes), { bytes: bytes.length, coding: 'deflate', ...more });
  }

  /** base: the numbers of the same series, for the filter xor-base. */
  numbers(numbers, filter = 'xor', base = null) {
    const type = Object.keys(arrays).find((name) => numbers instanceof arrays[name]);
    if (numbers.length > 1 && numbers.every((number) => Object.is(number, numbers[0]))) {
      return { type, count: numbers.length, constant: Number.isFinite(numbers[0]) ? numbers[0] : String(numbers[0]) };
    }
    const width = numbers.BYTES_PER_ELEMENT;
    const plain = bytes_of(numbers);
    let bytes = Uint8Array.from(plain);
    if (filter === 'xor') for (let i = bytes.length - 1; i >= width; --i) bytes[i] ^= plain[i - width];
    if (filter === 'xor-base') {
      const other = bytes_of(base);
      for (let i = 0; i < bytes.length; ++i) bytes[i] ^= other[i] ?? 0;
    }
    if (filter !== 'none') bytes = in_columns(bytes, width);
    return this.#add(deflateSync(bytes, { level: 1 }), {
      bytes: bytes.length,
      coding: 'deflate',
      type,
      count: numbers.length,
      filter,
    });
  }
}
