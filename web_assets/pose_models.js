// MediaPipe's pose models as its tasks want them: a detector and a landmark network, each told how
// its pixels are scaled, in one file that is a stored zip.

import { crc32 } from "node:zlib";

import { flatbuffer } from "./flatbuffer.js";

/** @import { Part } from "./flatbuffer.js" */

const NAME = "TFLITE_METADATA";
// Fields of a TFLite model's root table (schema.fbs), and options of a ProcessUnit and kinds of
// content (metadata_schema.fbs).
const [BUFFERS, METADATA] = [4, 6];
const NORMALIZATION = 1;
const IMAGE = 2;
const RGB = 1;

/**
 * What a model says of its one input: an RGB picture, of which it wants (value - mean) / std.
 *
 * @param {number} mean @param {number} std
 */
function metadata(mean, std) {
  const unit = {
    table: [{ byte: NORMALIZATION }, { table: [{ floats: [mean] }, { floats: [std] }] }],
  };
  const content = { table: [{ byte: IMAGE }, { table: [{ byte: RGB }] }] };
  const input = { table: [{ text: "image" }, null, null, content, { refs: [unit] }] };
  const graph = { table: [null, null, { refs: [input] }] };
  return flatbuffer({ table: [null, null, null, { refs: [graph] }] }, "M001");
}

/**
 * The model with metadata of its input. Offsets of flatbuffers only point forwards: a new root
 * goes before the old bytes, and takes over all that the old one points to.
 *
 * @param {Buffer} model @param {number} mean @param {number} std
 */
export function described(model, mean, std) {
  const at = model.readUInt32LE(0);
  const vtable = at - model.readInt32LE(at);
  const places = Array.from({ length: (model.readUInt16LE(vtable) - 4) / 2 }, (_, k) =>
    model.readUInt16LE(vtable + 4 + 2 * k),
  );
  /** @param {number} place @returns {number} */
  const target = (place) => place + model.readUInt32LE(place);
  /** @param {number} field @returns {Part[]} */
  const listed = (field) => {
    if (!places[field]) return [];
    const start = target(at + places[field]);
    return Array.from({ length: model.readUInt32LE(start) }, (_, k) => ({
      old: target(start + 4 + 4 * k),
    }));
  };
  const buffers = listed(BUFFERS);
  /** @type {(Part | null)[]} */
  const fields = Array.from({ length: Math.max(places.length, METADATA + 1) }, (_, k) =>
    !places[k]
      ? null
      : k
        ? { old: target(at + places[k]) }
        : { word: model.readUInt32LE(at + places[k]) },
  );
  const own = { table: [{ bytes: metadata(mean, std) }] };
  fields[BUFFERS] = { refs: [...buffers, own] };
  const entry = { table: [{ text: NAME }, { word: buffers.length }] };
  fields[METADATA] = { refs: [...listed(METADATA), entry] };
  return flatbuffer({ table: fields }, "TFL3", model);
}

/**
 * A zip of files that are not compressed, without dates
 * (https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT).
 *
 * @param {Record<string, Buffer>} files
 */
export function storedZip(files) {
  const parts = [];
  const directory = [];
  let offset = 0;
  for (const [name, data] of Object.entries(files)) {
    const head = Buffer.alloc(26);
    head.writeUInt16LE(20, 0); // version needed
    head.writeUInt16LE(0x21, 8); // 1980-01-01
    head.writeUInt32LE(crc32(data), 10);
    head.writeUInt32LE(data.length, 14);
    head.writeUInt32LE(data.length, 18);
    head.writeUInt16LE(name.length, 22);
    const place = Buffer.alloc(14);
    place.writeUInt32LE(offset, 10);
    parts.push(Buffer.from("PK\x03\x04"), head, Buffer.from(name), data);
    directory.push(Buffer.from("PK\x01\x02\x14\x00"), head, place, Buffer.from(name));
    offset += 30 + name.length + data.length;
  }
  const listed = Buffer.concat(directory);
  const end = Buffer.alloc(18);
  end.writeUInt16LE(Object.keys(files).length, 4);
  end.writeUInt16LE(Object.keys(files).length, 6);
  end.writeUInt32LE(listed.length, 8);
  end.writeUInt32LE(offset, 12);
  return Buffer.concat([...parts, listed, Buffer.from("PK\x05\x06"), end]);
}

/**
 * What MediaPipe's Pose Landmarker loads. The detector wants pixels in [-1, 1], the landmark
 * network in [0, 1].
 *
 * @param {Buffer} detector @param {Buffer} landmarks both TFLite
 */
export const poseTask = (detector, landmarks) =>
  storedZip({
    "pose_detector.tflite": described(detector, 127.5, 127.5),
    "pose_landmarks_detector.tflite": described(landmarks, 0, 255),
  });
