// Writes flatbuffers, parents before children, as far as set-up needs it
// (the format: https://flatbuffers.dev/internals/).

/** What a flatbuffer is made of, from a table down. Places are offsets into what lies behind. */
/** @typedef {{ table: (Part | null)[] } | { refs: Part[] } | { floats: number[] }
 *  | { text: string } | { bytes: Uint8Array } | { byte: number } | { word: number }
 *  | { old: number }} Part */

const WIDTH = 64; // what follows stays aligned as it was

/**
 * A flatbuffer of `root`, followed by `rest`, into which the parts `{ old }` point.
 *
 * @param {Part} root a table
 * @param {string} identifier of four letters
 * @param {Uint8Array} [rest]
 */
export function flatbuffer(root, identifier, rest = new Uint8Array()) {
  const bytes = new Uint8Array(2 ** 20);
  const view = new DataView(bytes.buffer);
  /** Where an offset has to be filled in, and to what. @type {[number, Part][]} */
  const waiting = [[0, root]];
  /** @type {[number, number][]} */
  const behind = [];
  let end = 8;
  bytes.set(Buffer.from(identifier, "latin1"), 4);

  const align = (/** @type {number} */ width) => (end = Math.ceil(end / width) * width);
  /** @param {ArrayLike<number>} data @param {number} count */
  const counted = (data, count) => {
    end += (12 - (end % 16) + 16) % 16; // the content at a multiple of 16
    const at = end;
    view.setUint32(at, count, true);
    bytes.set(data, at + 4);
    end += 4 + data.length;
    return at;
  };

  /** @param {(Part | null)[]} fields */
  const table = (fields) => {
    align(4);
    const size = 4 + 2 * fields.length;
    const at = Math.ceil((end + size) / 4) * 4;
    const vtable = at - size;
    view.setInt32(at, at - vtable, true);
    end = at + 4;
    fields.forEach((field, k) => {
      if (field === null) return;
      if (!("byte" in field)) align(4);
      view.setUint16(vtable + 4 + 2 * k, end - at, true);
      if ("byte" in field) bytes[end++] = field.byte;
      else {
        if ("word" in field) view.setUint32(end, field.word, true);
        else waiting.push([end, field]);
        end += 4;
      }
    });
    view.setUint16(vtable, size, true);
    view.setUint16(vtable + 2, end - at, true);
    return at;
  };

  /** @param {Part} part @returns {number} where it begins */
  const write = (part) => {
    if ("table" in part) return table(part.table);
    if ("refs" in part) {
      const at = counted(new Uint8Array(4 * part.refs.length), part.refs.length);
      part.refs.forEach((ref, k) => waiting.push([at + 4 + 4 * k, ref]));
      return at;
    }
    if ("floats" in part)
      return counted(new Uint8Array(Float32Array.from(part.floats).buffer), part.floats.length);
    if ("text" in part) {
      const said = Buffer.from(`${part.text}\0`);
      return counted(said, said.length - 1);
    }
    if ("bytes" in part) return counted(part.bytes, part.bytes.length);
    throw new Error("a number stands in its table");
  };

  for (const [at, part] of waiting) {
    // `waiting` grows meanwhile
    if ("old" in part) behind.push([at, part.old]);
    else view.setUint32(at, write(part) - at, true);
  }
  align(WIDTH);
  for (const [at, place] of behind) view.setUint32(at, end + place - at, true);
  return Buffer.concat([bytes.subarray(0, end), rest]);
}
