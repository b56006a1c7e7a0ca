// SPDX-License-Identifier: Apache-2.0
import {existsSync, readFileSync} from 'node:fs';

const ours = readFileSync(new URL('LICENSE', import.meta.url), 'utf8');

/** Name, version, licence and licence text of a package in node_modules. */
function notice(folder) {
  const {name, version, license} = JSON.parse(readFileSync(`${folder}/package.json`, 'utf8'));
  let text = '';
  if (existsSync(`${folder}/LICENSE`)) {
    text = readFileSync(`${folder}/LICENSE`, 'utf8');
  } else if (license === 'Apache-2.0') {  // the same text as the licence of elastocal
    const readme = readFileSync(`${folder}/README.md`, 'utf8');
    text = `${readme.match(/^Copyright [^]*?(?=\n\n|$)/m)?.[0] ?? ''}\n\n${ours}`;
  } else {
    throw new Error(`${name}: a package in the page has no file LICENSE`);
  }
  return `${name} ${version}, ${license}\n\n${text.trim()}\n`.replaceAll('©', '(c)');
}

/**
 * A plugin of vite that writes the licences of the bundled packages into the page, in place of @NOTICES@,
 * and into the file notices.txt.
 */
export function notices() {
  return {
    name: 'notices',
    enforce: 'post',
    generateBundle(_, bundle) {
      const folders = new Set();
      for (const chunk of Object.values(bundle)) {
        for (const id of chunk.moduleIds ?? []) {
          const folder = id.match(/^.*\/node_modules\/(?:@[^/]+\/)?[^/]+/)?.[0];
          if (folder) folders.add(folder);
        }
      }
      const text = [...folders].sort().map(notice).join(`\n${'-'.repeat(79)}\n\n`);
      this.emitFile({type: 'asset', fileName: 'notices.txt', source: text});
      const page = bundle['index.html'];
      page.source = page.source.replace('@NOTICES@', () => text.replaceAll('<', '&lt;'));
    },
  };
}
