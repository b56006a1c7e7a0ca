// SPDX-License-Identifier: Apache-2.0
/** Replaces three's ColladaLoader, which urdf-loader imports. All our meshes are STL. */
export class ColladaLoader {
  load() {
    throw new Error('Collada meshes are not embedded in reports');
  }
}
