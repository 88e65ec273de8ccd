// The texts of a PDF as Chromium prints it, page by page.

import { inflateSync } from "node:zlib";

/** The objects of the file by their numbers: dictionary, and stream if the object has one. */
function objectsOf(bytes) {
  const text = bytes.toString("latin1");
  const objects = new Map();
  for (const found of text.matchAll(/(?:^|\n)(\d+) 0 obj\s/g)) {
    const start = found.index + found[0].length;
    const end = text.indexOf("endobj", start);
    const stream = text.indexOf("stream", start);
    if (stream < 0 || stream > end) {
      objects.set(found[1], { dictionary: text.slice(start, end) });
      continue;
    }
    const dictionary = text.slice(start, stream);
    const from = stream + (text[stream + 6] === "\r" ? 8 : 7);
    const raw = bytes.subarray(from, from + Number(/\/Length (\d+)/.exec(dictionary)[1]));
    const content = dictionary.includes("/FlateDecode") ? inflateSync(raw) : raw;
    objects.set(found[1], { dictionary, stream: content.toString("latin1") });
  }
  return objects;
}

/** The signs of a font by the codes of its glyphs, from its table ToUnicode. */
function signsOf(table) {
  const signs = new Map();
  const sign = (hex) => String.fromCharCode(...hex.match(/.{4}/g).map((unit) => parseInt(unit, 16)));
  for (const [, block] of table.matchAll(/beginbfchar\n([^]*?)endbfchar/g)) {
    for (const [, code, to] of block.matchAll(/<(\w+)> <(\w+)>/g)) signs.set(parseInt(code, 16), sign(to));
  }
  for (const [, block] of table.matchAll(/beginbfrange\n([^]*?)endbfrange/g)) {
    for (const [, from, to, first] of block.matchAll(/<(\w+)> <(\w+)> <(\w+)>/g)) {
      for (let code = parseInt(from, 16); code <= parseInt(to, 16); code += 1) {
        signs.set(code, String.fromCharCode(parseInt(first, 16) + code - parseInt(from, 16)));
      }
    }
  }
  return signs;
}

/** The text of each page, without blanks. */
export function textsOf(bytes) {
  const objects = objectsOf(bytes);
  const pages = [...objects.values()].filter(({ dictionary }) => /\/Type\s*\/Page\b/.test(dictionary));
  return pages.map(({ dictionary }) => {
    const fonts = new Map();
    const [, resources] = /\/Font <<([^>]*)>>/.exec(dictionary) ?? [, ""];
    for (const [, name, number] of resources.matchAll(/\/(\w+) (\d+) 0 R/g)) {
      const table = /\/ToUnicode (\d+) 0 R/.exec(objects.get(number).dictionary);
      if (table) fonts.set(name, signsOf(objects.get(table[1]).stream));
    }
    const [, contents] = /\/Contents \[?(\d+) 0 R/.exec(dictionary);
    let text = "";
    let font = new Map();
    for (const [, name, hex] of objects.get(contents).stream.matchAll(/\/(\w+) [\d.]+ Tf|<([0-9A-Fa-f]+)>/g)) {
      if (name) font = fonts.get(name) ?? new Map();
      else for (const code of hex.match(/.{4}/g) ?? []) text += font.get(parseInt(code, 16)) ?? "";
    }
    return text.replaceAll(/\s/g, "");
  });
}
