// SPDX-License-Identifier: Apache-2.0
function bytes(base64) {
  const text = atob(base64);
  const result = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) result[i] = text.charCodeAt(i);
  return result;
}

/** Little-endian 32-bit floats from base64. NaN means an unseen marker. */
export function floats(base64) {
  const view = new DataView(bytes(base64 ?? '').buffer);
  const result = new Float32Array(view.byteLength / 4);
  for (let i = 0; i < result.length; ++i) result[i] = view.getFloat32(4 * i, true);
  return result;
}

/** Inflates deflated bytes (zlib) from base64. */
export async function inflated(base64) {
  const stream = new Blob([bytes(base64 ?? '')]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * Rows of `width` integers from bytes. A signed byte holds the difference to the row before (for the first row: to
 * zero). A byte of -128 means that the integer itself follows in four bytes, little-endian.
 */
export function differences(packed, width, rows) {
  const view = new DataView(packed.buffer, packed.byteOffset, packed.byteLength);
  const result = new Int32Array(width * rows);
  for (let i = 0, at = 0; i < result.length; ++i) {
    const step = view.getInt8(at++);
    if (step !== -128) {
      result[i] = step + (i >= width ? result[i - width] : 0);
    } else {
      result[i] = view.getInt32(at, true);
      at += 4;
    }
  }
  return result;
}

/** Signed bytes from base64. */
export const signedBytes = (base64) => new Int8Array(bytes(base64 ?? '').buffer);

/** The symmetric matrix whose lower triangle is given row by row. */
export function unpackTriangle(values, size) {
  const matrix = Array.from({length: size}, () => new Float32Array(size));
  let k = 0;
  for (let i = 0; i < size; ++i) {
    for (let j = 0; j <= i; ++j, ++k) matrix[i][j] = matrix[j][i] = values[k] / 100;
  }
  return matrix;
}
