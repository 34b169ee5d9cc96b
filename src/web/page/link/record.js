// record.js: how a picture was made, from the file of the picture or of its JSON (docs/formats.md, "How a picture was made").
const mostBytes = 1 << 26;  // of a file
const opening = 'iTXtvog\0\0\0\0\0';  // type of the chunk, keyword, no compression, no language

/** Text of a file; of a PNG its record; '': none. */
export async function recordIn(file) {
  if (file.size > mostBytes) return '';
  const bytes = new Uint8Array(await file.arrayBuffer()), view = new DataView(bytes.buffer);
  const text = (from, to) => new TextDecoder().decode(bytes.subarray(from, to));
  if (bytes.length < 8 || view.getUint32(0) !== 0x89504e47) return text(0);
  for (let at = 8; at + 12 <= bytes.length;) {
    const end = at + 8 + view.getUint32(at);
    if (text(at + 4, at + 4 + opening.length) === opening) return text(at + 4 + opening.length, end);
    at = end + 4;
  }
  return '';
}
