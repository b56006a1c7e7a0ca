// SPDX-License-Identifier: Apache-2.0

/**
 * A page with a single triangle in WebGL: the least time of a picture on this machine.
 * It signals that it is drawn like the viewer.
 */
export const trianglePage = `<!doctype html><meta charset="utf-8"><canvas width="600" height="400"></canvas>
<script type="module">
const canvas = document.querySelector('canvas');
const gl = canvas.getContext('webgl2', {antialias: true, alpha: true, preserveDrawingBuffer: true});
const program = gl.createProgram();
const sources = {
  VERTEX_SHADER: 'attribute vec2 corner; void main() { gl_Position = vec4(corner, 0.0, 1.0); }',
  FRAGMENT_SHADER: 'void main() { gl_FragColor = vec4(1.0, 0.5, 0.0, 1.0); }',
};
for (const [kind, source] of Object.entries(sources)) {
  const shader = gl.createShader(gl[kind]);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  gl.attachShader(program, shader);
}
gl.bindAttribLocation(program, 0, 'corner');
gl.linkProgram(program);
gl.useProgram(program);
gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, 0, 1]), gl.STATIC_DRAW);
gl.enableVertexAttribArray(0);
gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
gl.drawArrays(gl.TRIANGLES, 0, 3);
const pixel = new Uint8Array(4);
gl.readPixels(300, 100, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
if (pixel[0] !== 255) throw new Error('no triangle was drawn');
canvas.className = 'viewer';
canvas.dataset.ready = String(Math.round(performance.now()));
</script>`;
