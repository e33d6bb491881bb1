// Checks recordings with an independent implementation of MCAP, @mcap/core for JavaScript: every CRC, every index
// against the records, and the statistics against counts.
//
//   npm install --prefix /tmp/mcap @mcap/core@2.2.2
//   NODE_PATH=/tmp/mcap/node_modules node benchmarks/check_recordings.cjs FILE...
//
// Exit code 1 if anything is wrong with a file.
"use strict";

const { readFileSync } = require("node:fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");

/** Counts the records of a file, reading it from beginning to end. */
function readAll(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true, includeChunks: true });
  reader.append(bytes);
  const found = { types: new Map(), perChannel: new Map(), schemas: new Set(), channels: new Map(), problems: [] };
  let last;
  for (let record = reader.nextRecord(); record != undefined; record = reader.nextRecord()) {
    found.types.set(record.type, (found.types.get(record.type) ?? 0) + 1);
    last = record;
    if (record.type === "Message") {
      found.perChannel.set(record.channelId, (found.perChannel.get(record.channelId) ?? 0) + 1);
      if (!found.channels.has(record.channelId)) {
        found.problems.push(`a message comes before its channel ${record.channelId}`);
      }
    } else if (record.type === "Channel") {
      found.channels.set(record.id, record.topic);
      if (record.schemaId !== 0 && !found.schemas.has(record.schemaId)) {
        found.problems.push(`channel ${record.topic} comes before its schema ${record.schemaId}`);
      }
    } else if (record.type === "Schema") {
      found.schemas.add(record.id);
    } else if (record.type === "Chunk") {
      if (record.messageEndTime < record.messageStartTime) {
        found.problems.push("a chunk ends before it begins");
      }
    }
  }
  if (!reader.done()) {
    found.problems.push(`the file does not end where its last record does, ${last?.type}`);
  }
  return found;
}

/** Finds the problems of a file, as sentences. */
async function check(path) {
  const bytes = new Uint8Array(readFileSync(path));
  const all = readAll(bytes);
  const problems = all.problems;
  const equal = (what, expected, got) => {
    if (String(expected) !== String(got)) {
      problems.push(`expected ${expected} ${what}, got ${got}`);
    }
  };
  const readable = {
    size: async () => BigInt(bytes.byteLength),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const statistics = reader.statistics;
  const n = (type) => all.types.get(type) ?? 0;
  equal("messages in the statistics", n("Message"), statistics.messageCount);
  equal("chunks in the statistics", n("Chunk"), statistics.chunkCount);
  equal("chunk indexes", n("Chunk"), reader.chunkIndexes.length);
  equal("channels in the statistics", all.channels.size, statistics.channelCount);
  equal("channels in the summary", all.channels.size, reader.channelsById.size);
  equal("schemas in the statistics", all.schemas.size, statistics.schemaCount);
  equal("schemas in the summary", all.schemas.size, reader.schemasById.size);
  equal("attachments in the statistics", n("Attachment"), statistics.attachmentCount);
  equal("attachment indexes", n("Attachment"), reader.attachmentIndexes.length);
  equal("metadata in the statistics", n("Metadata"), statistics.metadataCount);
  equal("metadata indexes", n("Metadata"), reader.metadataIndexes.length);
  for (const [id, count] of all.perChannel) {
    equal(`messages of channel ${all.channels.get(id)} in the statistics`, count, statistics.channelMessageCounts.get(id));
  }

  let [nMessages, before, begin, end] = [0, 0n, undefined, undefined];
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    nMessages += 1;
    if (message.logTime < before) {
      problems.push(`message ${nMessages} comes before the one in front of it`);
    }
    before = end = message.logTime;
    begin ??= message.logTime;
  }
  equal("messages by the indexes", n("Message"), nMessages);
  equal("as the time of the first message", begin ?? 0n, statistics.messageStartTime);
  equal("as the time of the last message", end ?? 0n, statistics.messageEndTime);
  for (const [id, topic] of all.channels) {
    let count = 0;
    for await (const message of reader.readMessages({ topics: [topic], validateCrcs: true })) {
      count += message.channelId === id ? 1 : 0;
    }
    equal(`messages of channel ${topic} by the indexes`, all.perChannel.get(id) ?? 0, count);
  }
  let nAttachments = 0;
  for await (const _ of reader.readAttachments({ validateCrcs: true })) {
    nAttachments += 1;
  }
  equal("attachments by the indexes", n("Attachment"), nAttachments);
  let nMetadata = 0;
  for await (const _ of reader.readMetadata()) {
    nMetadata += 1;
  }
  equal("metadata by the indexes", n("Metadata"), nMetadata);
  return { problems, nMessages, nAttachments };
}

async function main(paths) {
  let nBad = 0;
  for (const path of paths) {
    let result;
    try {
      result = await check(path);
    } catch (error) {
      result = { problems: [error.message], nMessages: 0, nAttachments: 0 };
    }
    nBad += result.problems.length > 0 ? 1 : 0;
    const words = result.problems.length > 0 ? result.problems.join("; ") : "no error";
    console.log(`${path}: ${result.nMessages} messages, ${result.nAttachments} attachments: ${words}`);
  }
  process.exitCode = nBad > 0 ? 1 : 0;
}

main(process.argv.slice(2));
