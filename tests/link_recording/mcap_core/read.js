// Reads a recording of `foresight record --line` with programs of others: MCAP's own reader, and decoders of ROS 2's and
// OMG's messages that know nothing but the definitions in the file.
//
//   node read.js FILE [--cut]     --cut: the file has no end; it is read as a stream
//
// Prints each topic with its type and number of messages, and one message's main fields. Exit code 1: something does
// not decode, or is not what it should be.
import { open, readFile } from "node:fs/promises";

import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader as IdlReader } from "@foxglove/omgidl-serialization";
import { parse as parseRos } from "@foxglove/rosmsg";
import { MessageReader as RosReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";

const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };

function readerOf(schema) {
  if (schema.encoding === "ros2msg")
    return new RosReader(parseRos(new TextDecoder().decode(schema.data), { ros2: true }));
  if (schema.encoding === "omgidl") return new IdlReader(schema.name, parseIDL(new TextDecoder().decode(schema.data)));
  return undefined;
}

class Topics {
  channels = new Map();
  schemas = new Map();
  readers = new Map();
  counts = new Map();
  samples = new Map();

  take(message) {
    const channel = this.channels.get(message.channelId);
    const schema = this.schemas.get(channel.schemaId);
    if (!this.readers.has(channel.id)) this.readers.set(channel.id, readerOf(schema));
    const key = `${channel.topic} (${schema.name})`;
    this.counts.set(key, (this.counts.get(key) ?? 0) + 1);
    const decoded = this.readers.get(channel.id)?.readMessage(message.data);
    if (decoded) this.samples.set(channel.topic, decoded);
    if (message.publishTime > message.logTime + 10_000_000_000n) throw new Error(`${channel.topic}: stamps`);
  }
}

async function readIndexed(path, topics) {
  const file = await open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const bytes = new Uint8Array(Number(size));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  topics.channels = reader.channelsById;
  topics.schemas = reader.schemasById;
  let messages = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    topics.take(message);
    ++messages;
  }
  if (reader.header.profile !== "ros2") throw new Error("profile");
  if (messages !== reader.statistics.messageCount) throw new Error("the statistics count other messages");
  for await (const attachment of reader.readAttachments({ validateCrcs: true }))
    console.log(`attachment ${attachment.name}, ${attachment.data.length} bytes`);
  for await (const metadata of reader.readMetadata())
    console.log(`metadata ${metadata.name}: ${[...metadata.metadata.keys()].join(", ")}`);
  await file.close();
}

async function readStream(path, topics) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(await readFile(path));
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") topics.schemas.set(record.id, record);
    if (record.type === "Channel") topics.channels.set(record.id, record);
    if (record.type === "Message") topics.take(record);
  }
}

function check(topics) {
  const joints = topics.samples.get("/joint_states"); // none while nothing is homed
  if (joints) {
    if (joints.name.length === 0 || joints.name.length !== joints.position.length) throw new Error("joint_states");
    console.log(`joint_states: ${joints.name.map((name, i) => `${name}=${joints.position[i].toFixed(3)}`).join(" ")}`);
  }
  const state = topics.samples.get("/foresight/robot_state");
  console.log(`robot_state: rig ${state.rig}, gate ${state.gate.label}`);
  const frame = topics.samples.get("/foresight/frames");
  if (frame) {
    const jpeg = frame.coding !== "jpeg" || (frame.left.data[0] === 0xff && frame.left.data[1] === 0xd8);
    if (!jpeg || frame.left.width === 0) throw new Error("frames");
    console.log(`frames: pair ${frame.number}, ${frame.left.width} x ${frame.left.height}, ${frame.left.data.length} bytes`);
  }
  const desk = topics.samples.get("/foresight/control/robot/messages");
  if (desk && typeof desk.from !== "bigint") throw new Error("control");
}

const [path, cut] = process.argv.slice(2);
const topics = new Topics();
await (cut ? readStream : readIndexed)(path, topics);
for (const [topic, count] of [...topics.counts].sort()) console.log(`${topic}: ${count}`);
check(topics);
