// SPDX-License-Identifier: Apache-2.0
// Runs the tests of one folder: node test/run.mjs unit | browser
// Ends with 77 if a browser is needed and missing, which ctest reports as skipped.
import {spawnSync} from 'node:child_process';
import {readdirSync} from 'node:fs';
import {fileURLToPath} from 'node:url';

const folder = process.argv[2];
if (folder === 'browser') {
  const {chromiumPath} = await import('./browser/chromium.js');
  if (!chromiumPath()) {
    console.log('Skipped: there is no Chromium here (Debian: apt-get install chromium; or set CHROMIUM).');
    process.exit(77);
  }
}
const path = fileURLToPath(new URL(`./${folder}/`, import.meta.url));
const files = readdirSync(path).filter((name) => name.endsWith('.test.js')).map((name) => path + name);
const {status} = spawnSync(process.execPath, ['--test', ...files], {stdio: 'inherit'});
process.exit(status ?? 1);
