// SPDX-License-Identifier: Apache-2.0
import {fileURLToPath} from 'node:url';
import {defineConfig} from 'vite';
import {viteSingleFile} from 'vite-plugin-singlefile';

import {notices} from './notices.js';

const here = (path) => fileURLToPath(new URL(path, import.meta.url));

// Bundles everything into one file. Collada meshes are never embedded, so their big loader is left out.
export default defineConfig({
  plugins: [notices(), viteSingleFile({removeViteModuleLoader: true})],
  resolve: {
    alias: {'three/examples/jsm/loaders/ColladaLoader.js': here('src/viewer/no_collada.js')},
    dedupe: ['three'],
  },
  esbuild: {charset: 'ascii'},  // the page is compiled as string literals of C++
  build: {target: 'es2021', chunkSizeWarningLimit: 2000, reportCompressedSize: false},
});
