"use strict";
// Reads the data of the page: JSON, in which packed arrays are named, and one deflated block with their bytes.

/** The data of the page; every packed array replaces its name. */
async function unpackedData() {
  const data = JSON.parse(document.getElementById("data").textContent);
  return withArrays(data, await inflated(document.getElementById("arrays").textContent.trim()));
}

/** The bytes of a text in base64 that were deflated without a header. */
async function inflated(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function withArrays(value, block) {
  if (Array.isArray(value)) return value.map(entry => withArrays(entry, block));
  if (value === null || typeof value !== "object") return value;
  if (typeof value.form === "string" && "at" in value && "stride" in value) return unpacked(value, block);
  return Object.fromEntries(Object.entries(value).map(([key, entry]) => [key, withArrays(entry, block)]));
}

/** An array as it was packed: component after component, in byte planes. */
function unpacked({ form, at, count, stride, ranges }, block) {
  const items = count / stride;
  switch (form) {
    case "bytes":
      return block.subarray(at, at + count);
    case "quantised":
      return quantised(block, at, items, ranges);
    case "whole":
      return whole(block, at, items, stride);
    default:
      return exact(block, at, items, stride);
  }
}

const NO_VALUE = 65535,
  MOST = 65534;

function quantised(block, at, items, ranges) {
  const stride = ranges.length,
    values = new Float32Array(items * stride);
  ranges.forEach(([low, high], component) => {
    const step = (high - low) / MOST,
      first = at + 2 * component * items;
    for (let i = 0, number = 0; i < items; i++) {
      number = (number + block[first + i] + (block[first + items + i] << 8)) & 0xffff;
      values[i * stride + component] = number === NO_VALUE ? NaN : low + number * step;
    }
  });
  return values;
}

function whole(block, at, items, stride) {
  const values = new Uint32Array(items * stride);
  for (let component = 0; component < stride; component++) {
    const first = at + 4 * component * items;
    for (let i = 0, number = 0; i < items; i++) {
      for (let plane = 0; plane < 4; plane++)
        number = (number + (block[first + plane * items + i] << (8 * plane))) >>> 0;
      values[i * stride + component] = number;
    }
  }
  return values;
}

function exact(block, at, items, stride) {
  const values = new Float64Array(items * stride),
    one = new DataView(new ArrayBuffer(8));
  for (let component = 0; component < stride; component++) {
    const first = at + 8 * component * items;
    for (let i = 0; i < items; i++) {
      for (let plane = 0; plane < 8; plane++) one.setUint8(plane, block[first + plane * items + i]);
      values[i * stride + component] = one.getFloat64(0, true);
    }
  }
  return values;
}
