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

const NO_VALUE = 65535,
  MOST = 65534;

/** The forms of numbers: their list, the bytes of each, and its value; whole ones are packed as differences. */
const FORMS = {
  quantised: { List: Float32Array, width: 2, read: (bytes, before) => (before + bytes.getUint16(0, true)) & 0xffff },
  whole: { List: Uint32Array, width: 4, read: (bytes, before) => (before + bytes.getUint32(0, true)) >>> 0 },
  exact: { List: Float64Array, width: 8, read: bytes => bytes.getFloat64(0, true) },
};

/** An array as it was packed. */
function unpacked(packed, block) {
  const { form, at, count } = packed;
  return form === "bytes" ? block.subarray(at, at + count) : numbersOf(packed, block);
}

/** Numbers that stand component after component, in byte planes. */
function numbersOf({ form, at, count, stride, ranges }, block) {
  const { List, width, read } = FORMS[form],
    values = new List(count),
    items = count / stride,
    bytes = new DataView(new ArrayBuffer(width));
  for (let component = 0; component < stride; component++) {
    const first = at + width * component * items,
      valueOf = ranges ? inRange(ranges[component]) : number => number;
    for (let i = 0, number = 0; i < items; i++) {
      for (let plane = 0; plane < width; plane++) bytes.setUint8(plane, block[first + plane * items + i]);
      number = read(bytes, number);
      values[i * stride + component] = valueOf(number);
    }
  }
  return values;
}

/** The value of a quantised number between the lowest and the highest of its component. */
function inRange([low, high]) {
  const step = (high - low) / MOST;
  return number => (number === NO_VALUE ? NaN : low + number * step);
}
