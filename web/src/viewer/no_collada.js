// SPDX-License-Identifier: Apache-2.0
/** Stands for three's ColladaLoader, which urdf-loader imports; meshes come to us as STL only. */
export class ColladaLoader {
  load() {
    throw new Error('Collada meshes are not embedded in reports');
  }
}
