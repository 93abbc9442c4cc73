import assert from "node:assert/strict";
import test from "node:test";
import { crc32 } from "node:zlib";

import { flatbuffer } from "../flatbuffer.js";
import { described, poseTask, storedZip } from "../pose_models.js";

/** A table of a flatbuffer, read as its format says. */
class Table {
  constructor(bytes, at = bytes.readUInt32LE(0)) {
    this.bytes = bytes;
    this.at = at;
    this.vtable = at - bytes.readInt32LE(at);
  }

  place(field) {
    const shift = this.bytes.readUInt16LE(this.vtable + 4 + 2 * field);
    return shift && this.at + shift;
  }

  target(field) {
    const place = this.place(field);
    return place + this.bytes.readUInt32LE(place);
  }

  table(field) {
    return new Table(this.bytes, this.target(field));
  }

  tables(field) {
    const start = this.target(field);
    return Array.from({ length: this.bytes.readUInt32LE(start) }, (_, k) => {
      const at = start + 4 + 4 * k;
      return new Table(this.bytes, at + this.bytes.readUInt32LE(at));
    });
  }

  content(field) {
    const start = this.target(field);
    return this.bytes.subarray(start + 4, start + 4 + this.bytes.readUInt32LE(start));
  }

  float(field) {
    const start = this.target(field);
    assert.equal(this.bytes.readUInt32LE(start), 1);
    return this.bytes.readFloatLE(start + 4);
  }
}

/** Version 3, a description, and two buffers of which the second holds weights. */
const weights = Uint8Array.from({ length: 37 }, (_, k) => 7 * k);
const model = flatbuffer(
  {
    table: [
      { word: 3 },
      null,
      { refs: [] },
      { text: "a model" },
      { refs: [{ table: [] }, { table: [{ bytes: weights }] }] },
    ],
  },
  "TFL3",
);

test("a model keeps what it holds, and says how its pixels are scaled", () => {
  const root = new Table(described(model, 127.5, 127.5));
  assert.equal(root.bytes.subarray(4, 8).toString(), "TFL3");
  assert.equal(root.bytes.readUInt32LE(root.place(0)), 3);
  assert.equal(root.content(3).toString(), "a model");
  const buffers = root.tables(4);
  assert.equal(buffers.length, 3);
  assert.deepEqual(new Uint8Array(buffers[1].content(0)), weights);

  const [entry] = root.tables(6);
  assert.equal(entry.content(0).toString(), "TFLITE_METADATA");
  const number = root.bytes.readUInt32LE(entry.place(1));
  const said = Buffer.from(buffers[number].content(0));
  assert.equal(said.subarray(4, 8).toString(), "M001");
  const [input] = new Table(said).tables(3)[0].tables(2);
  const [unit] = input.tables(4);
  assert.equal(unit.bytes[unit.place(0)], 1);
  assert.equal(unit.table(1).float(0), 127.5);
  assert.equal(unit.table(1).float(1), 127.5);
});

test("a model that is described again keeps the first description too", () => {
  const root = new Table(described(described(model, 0, 1), 0, 255));
  assert.equal(root.tables(6).length, 2);
  assert.equal(root.tables(4).length, 4);
});

test("each vector's content lies at a multiple of sixteen bytes", () => {
  const bytes = flatbuffer({ table: [{ text: "odd" }, { bytes: weights }] }, "TEST");
  const root = new Table(bytes);
  for (const field of [0, 1]) assert.equal((root.target(field) + 4) % 16, 0);
});

test("files of a zip are found by its directory, whole", () => {
  const files = { "a.bin": Buffer.from("first"), "bb.bin": Buffer.from("the second") };
  const zip = storedZip(files);
  const end = zip.length - 22;
  assert.equal(zip.readUInt32LE(end), 0x06054b50);
  assert.equal(zip.readUInt16LE(end + 10), 2);
  let entry = zip.readUInt32LE(end + 16);
  for (const [name, data] of Object.entries(files)) {
    assert.equal(zip.readUInt32LE(entry), 0x02014b50);
    assert.equal(zip.readUInt16LE(entry + 10), 0); // stored
    assert.equal(zip.readUInt32LE(entry + 16), crc32(data));
    const at = zip.readUInt32LE(entry + 42);
    assert.equal(zip.readUInt32LE(at), 0x04034b50);
    const from = at + 30 + name.length;
    assert.equal(zip.subarray(at + 30, from).toString(), name);
    assert.deepEqual(zip.subarray(from, from + zip.readUInt32LE(at + 22)), data);
    entry += 46 + name.length;
  }
  assert.equal(entry, end);
});

test("a task holds the detector and the landmark network", () => {
  const task = poseTask(model, model).toString("latin1");
  for (const name of ["pose_detector.tflite", "pose_landmarks_detector.tflite"])
    assert.equal(task.split(name).length, 3); // its head and the directory
});
