// Draws with WebGPU.

import { COLOURS, SHADOW } from "./look.js";

// `look`: the position of the eye, and the strain at which the colours saturate; 0 draws no strain.
const CODE = `
struct Look { matrix: mat4x4f, light: mat4x4f, look: vec4f, paper: vec4f }
@group(0) @binding(0) var<uniform> u: Look;
@group(0) @binding(1) var map: texture_depth_2d;
@group(0) @binding(2) var compare: sampler_comparison;
struct Seen {
  @builtin(position) clip: vec4f, @location(0) place: vec3f, @location(1) normal: vec3f, @location(2) uv: vec2f,
  @location(3) strain: f32, @location(4) mark: f32, @location(5) @interpolate(flat) kind: u32,
}
// 0 cloth, 1 strained cloth, 2 body, 3 floor, 4 glass
fn seen(place: vec3f, normal: vec3f, uv: vec2f, strain: f32, mark: f32, kind: u32) -> Seen {
  return Seen(u.matrix * vec4f(place, 1.0), place, normal, uv, strain, mark, kind);
}
@vertex fn cloth(@location(0) place: vec3f, @location(1) normal: vec3f, @location(2) strain: f32, @location(3) uv: vec2f) -> Seen {
  let isMarked = strain > 1e8;
  let shown = select(clamp(strain / max(u.look.w, 1e-9), -1.0, 1.0), 0.0, isMarked);
  return seen(place, normal, uv, shown, f32(isMarked), u32(u.look.w > 0.0));
}
@vertex fn body(@location(0) place: vec3f, @location(1) normal: vec3f, @location(2) kind: f32) -> Seen {
  return seen(place, normal, vec2f(), 0.0, 0.0, 2u + u32(kind));
}
@vertex fn depth(@location(0) place: vec3f) -> @builtin(position) vec4f { return u.light * vec4f(place, 1.0); }
@fragment fn shade(v: Seen) -> @location(0) vec4f {
  let eye = normalize(u.look.xyz - v.place);
  var n = normalize(v.normal);
  if (dot(n, eye) < 0.0) { n = -n; }
  let w = fwidth(v.uv);
  let stripe = mix(smoothstep(.25 - w, .25 + w, abs(fract(v.uv) - .5)), vec2f(.5), clamp(2.0 * w, vec2f(), vec2f(1)));
  let l = (u.light * vec4f(v.place, 1.0)).xyz;
  let at = vec2f(.5, -.5) * l.xy + .5;
  let sampled = textureSampleCompareLevel(map, compare, at, l.z - .004);
  let lit = select(1.0, sampled, all(abs(l.xy) < vec2f(1)) && l.z < 1.0);
  var colour = vec3f(${COLOURS.cloth});
  switch v.kind {
    case 0: { colour *= mix(1.0, .84, stripe.x) * mix(1.0, .84, stripe.y); }
    case 1: { colour = mix(vec3f(.93), select(vec3f(${COLOURS.compressed}), vec3f(${COLOURS.stretched}), v.strain > 0.0), abs(v.strain)); }
    case 3: { colour = u.paper.rgb; }
    default: { colour = vec3f(${COLOURS.body}); }
  }
  if (v.mark > .6) { colour = vec3f(.1); }
  var light = .4 + .5 * lit * max(dot(n, vec3f(${SHADOW.sun})), 0.0) + .18 * max(dot(n, eye), 0.0);
  if (v.kind == 3) { light = .78 + .22 * lit; }
  // From below the floor is not seen.
  if (v.kind == 3 && dot(normalize(v.normal), eye) < 0.0) { discard; }
  return vec4f(colour * light, select(1.0, .15, v.kind == 4));
}`;

const SAMPLES = 4;
const FORMAT = "depth24plus";
const BLEND = { srcFactor: "src-alpha", dstFactor: "one-minus-src-alpha" };

const number = (shaderLocation, count, offset = 0) => ({
  shaderLocation,
  offset,
  format: count > 1 ? `float32x${count}` : "float32",
});
const column = (at, count) => ({ arrayStride: 4 * count, attributes: [number(at, count)] });
/** The columns of the cloth, and the corners of bodies: place, normal and kind. */
const CLOTH = [column(0, 3), column(1, 3), column(2, 1), column(3, 2)];
const BODY = [{ arrayStride: 28, attributes: [number(0, 3), number(1, 3, 12), number(2, 1, 24)] }];
const PLACES = [{ arrayStride: 28, attributes: [number(0, 3)] }];

/** The pipelines of the picture and of the depth map, by name. */
async function pipelines(device, format) {
  const module = device.createShaderModule({ code: CODE });
  const { VERTEX, FRAGMENT } = GPUShaderStage;
  const entries = [{ binding: 0, visibility: VERTEX | FRAGMENT, buffer: {} }];
  const map = [
    { binding: 1, visibility: FRAGMENT, texture: { sampleType: "depth" } },
    { binding: 2, visibility: FRAGMENT, sampler: { type: "comparison" } },
  ];
  const layouts = [entries, entries.concat(map)].map((entries) => device.createBindGroupLayout({ entries }));
  const [casting, seeing] = layouts.map((layout) => device.createPipelineLayout({ bindGroupLayouts: [layout] }));
  const picture = (entryPoint, buffers, isGlass = false) =>
    device.createRenderPipelineAsync({
      layout: seeing,
      vertex: { module, entryPoint, buffers },
      fragment: { module, entryPoint: "shade", targets: [{ format, blend: isGlass ? { color: BLEND, alpha: BLEND } : undefined }] },
      depthStencil: { format: FORMAT, depthWriteEnabled: !isGlass, depthCompare: "less" },
      multisample: { count: SAMPLES },
    });
  const depth = (buffers) =>
    device.createRenderPipelineAsync({
      layout: casting,
      vertex: { module, entryPoint: "depth", buffers },
      depthStencil: { format: FORMAT, depthWriteEnabled: true, depthCompare: "less", depthBias: 2, depthBiasSlopeScale: 2 },
    });
  const all = [picture("cloth", CLOTH), picture("body", BODY), picture("body", BODY, true), depth([CLOTH[0]]), depth(PLACES)];
  const [cloth, body, glass, clothDepth, bodyDepth] = await Promise.all(all);
  return { cloth, body, glass, clothDepth, bodyDepth, layouts };
}

/** A renderer for a canvas, or undefined if WebGPU is not available. `lost` is called when the device is lost. */
export async function webgpu(canvas, lost) {
  const adapter = await navigator.gpu?.requestAdapter();
  const device = await adapter?.requestDevice();
  if (!device) return undefined;
  const format = navigator.gpu.getPreferredCanvasFormat();
  const { layouts, ...programs } = await pipelines(device, format);
  // This comes last, because a canvas that has one kind of context cannot get another.
  const context = canvas.getContext("webgpu");
  if (!context) return undefined;
  context.configure({ device, format, alphaMode: "opaque" });
  device.lost.then(({ message }) => lost(message || "no reason given"));
  const { VERTEX, INDEX, UNIFORM, COPY_DST } = GPUBufferUsage;
  const { RENDER_ATTACHMENT, TEXTURE_BINDING } = GPUTextureUsage;
  const uniform = device.createBuffer({ size: 160, usage: UNIFORM | COPY_DST });
  const side = SHADOW.size;
  const map = device.createTexture({ size: [side, side], format: FORMAT, usage: RENDER_ATTACHMENT | TEXTURE_BINDING }).createView();
  const compare = device.createSampler({ compare: "less", minFilter: "linear", magFilter: "linear" });
  const resources = [{ buffer: uniform }, map, compare];
  const [casting, seeing] = layouts.map((layout, k) =>
    device.createBindGroup({ layout, entries: resources.slice(0, k ? 3 : 1).map((resource, binding) => ({ binding, resource })) }),
  );
  const buffers = {};
  const write = (name, data, usage) => {
    if (!(buffers[name]?.size >= data.byteLength)) {
      buffers[name]?.destroy();
      buffers[name] = device.createBuffer({ size: Math.max(16, data.byteLength), usage: usage | COPY_DST });
    }
    device.queue.writeBuffer(buffers[name], 0, data);
  };
  let targets = [];
  const target = (format) =>
    device.createTexture({ size: [canvas.width, canvas.height], sampleCount: SAMPLES, format, usage: RENDER_ATTACHMENT });
  let indices = 0;
  const cloth = (pass, pipeline, columns) => {
    pass.setPipeline(pipeline);
    columns.forEach((name, slot) => pass.setVertexBuffer(slot, buffers[name]));
    pass.setIndexBuffer(buffers.triangles, "uint32");
    pass.drawIndexed(indices);
  };
  const bodies = (pass, pipeline, from, to) => {
    if (to <= from) return;
    pass.setPipeline(pipeline);
    pass.setVertexBuffer(0, buffers.bodies);
    pass.draw(to - from, 1, from);
  };
  const depth = (view, storeOp) => ({ view, depthClearValue: 1, depthLoadOp: "clear", depthStoreOp: storeOp });
  return {
    name: "WebGPU",
    // Lets a test lose the device, because a real loss cannot be forced.
    lose: () => device.destroy(),
    mesh({ triangles, uvs }) {
      indices = triangles.length;
      write("triangles", triangles, INDEX);
      write("uvs", uvs, VERTEX);
    },
    draw({ positions, normals, strains, bodies: { corners, glass, floor }, matrix, light, look, paper }) {
      if (targets[0]?.width !== canvas.width || targets[0]?.height !== canvas.height) {
        targets.forEach((texture) => texture.destroy());
        targets = [target(format), target(FORMAT)];
      }
      Object.entries({ positions, normals, strains, bodies: corners }).forEach(([name, data]) => write(name, data, VERTEX));
      device.queue.writeBuffer(uniform, 0, new Float32Array([...matrix, ...light, ...look, ...paper, 1]));
      const encoder = device.createCommandEncoder();
      const shadow = encoder.beginRenderPass({ colorAttachments: [], depthStencilAttachment: depth(map, "store") });
      shadow.setBindGroup(0, casting);
      cloth(shadow, programs.clothDepth, ["positions"]);
      bodies(shadow, programs.bodyDepth, floor, glass);
      shadow.end();
      const colour = {
        view: targets[0].createView(),
        resolveTarget: context.getCurrentTexture().createView(),
        clearValue: [...paper, 1],
        loadOp: "clear",
        storeOp: "discard",
      };
      const pass = encoder.beginRenderPass({
        colorAttachments: [colour],
        depthStencilAttachment: depth(targets[1].createView(), "discard"),
      });
      pass.setBindGroup(0, seeing);
      cloth(pass, programs.cloth, ["positions", "normals", "strains", "uvs"]);
      bodies(pass, programs.body, 0, glass);
      bodies(pass, programs.glass, glass, corners.length / 7);
      pass.end();
      device.queue.submit([encoder.finish()]);
    },
  };
}
