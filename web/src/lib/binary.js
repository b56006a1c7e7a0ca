function bytes(base64) {
  const text = atob(base64);
  const result = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) result[i] = text.charCodeAt(i);
  return result;
}

/** Little-endian 32-bit floats from base64; the NaNs of unseen markers are kept. */
export function floats(base64) {
  const view = new DataView(bytes(base64 ?? '').buffer);
  const result = new Float32Array(view.byteLength / 4);
  for (let i = 0; i < result.length; ++i) result[i] = view.getFloat32(4 * i, true);
  return result;
}

/** Signed bytes from base64. */
export const signedBytes = (base64) => new Int8Array(bytes(base64 ?? '').buffer);
