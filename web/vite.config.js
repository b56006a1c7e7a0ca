// SPDX-License-Identifier: Apache-2.0
import {fileURLToPath} from 'node:url';
import {defineConfig} from 'vite';
import {viteSingleFile} from 'vite-plugin-singlefile';

import {notices} from './notices.js';

const here = (path) => fileURLToPath(new URL(path, import.meta.url));

// One file with everything in it. Collada meshes are not embedded, so their big loader stays out.
export default defineConfig({
  plugins: [notices(), viteSingleFile({removeViteModuleLoader: true})],
  resolve: {
    alias: {'three/examples/jsm/loaders/ColladaLoader.js': here('src/viewer/no_collada.js')},
    dedupe: ['three'],
  },
  esbuild: {charset: 'ascii'},  // the page becomes string literals of C++
  build: {target: 'es2021', chunkSizeWarningLimit: 2000, reportCompressedSize: false},
});
