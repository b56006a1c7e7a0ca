// SPDX-License-Identifier: Apache-2.0
/** One cell. Text that a spreadsheet would take for a formula stays text. */
function cell(value) {
  if (value === undefined || value === null || Number.isNaN(value)) return '';
  if (typeof value === 'number') return String(value);
  const text = /^[=+\-@\t]/.test(value) ? `'${value}` : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** A table as CSV, from names of columns and rows of numbers and texts. */
export function toCsv(columns, rows) {
  return [columns, ...rows].map((row) => Array.from(row, cell).join(',') + '\n').join('');
}

/** A table as CSV, from columns of numbers as in plots. */
export function columnsToCsv(names, columns) {
  const rows = Array.from({length: columns[0]?.length ?? 0}, (_, i) => columns.map((c) => c[i]));
  return toCsv(names, rows);
}

/** Lets the browser save a text as a file. */
export function saveText(name, text) {
  const url = URL.createObjectURL(new Blob([text], {type: 'text/csv'}));
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
