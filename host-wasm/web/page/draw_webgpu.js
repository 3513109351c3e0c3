// Draws with WebGPU.

// `look`: the position of the eye, and the strain at which the colours saturate; 0 draws no strain.
const CODE = `
struct Look { matrix: mat4x4f, look: vec4f }
@group(0) @binding(0) var<uniform> u: Look;
struct Seen { @builtin(position) clip: vec4f, @location(0) place: vec3f, @location(1) normal: vec3f, @location(2) colour: vec3f }
@vertex fn cloth(@location(0) place: vec3f, @location(1) normal: vec3f, @location(2) strain: f32) -> Seen {
  let s = clamp(strain / max(u.look.w, 1e-9), -1.0, 1.0);
  let strained = mix(vec3f(.92), select(vec3f(.1, .3, .8), vec3f(.8, .1, .1), s > 0.0), abs(s));
  return Seen(u.matrix * vec4f(place, 1.0), place, normal, select(select(vec3f(.85, .62, .45), strained, u.look.w > 0.0), vec3f(.1), strain > 1e8));
}
@vertex fn body(@location(0) place: vec3f, @location(1) normal: vec3f) -> Seen {
  return Seen(u.matrix * vec4f(place, 1.0), place, normal, vec3f(.5, .53, .56));
}
@fragment fn shade(v: Seen) -> @location(0) vec4f {
  let to_eye = normalize(u.look.xyz - v.place);
  var n = normalize(v.normal);
  if (dot(n, to_eye) < 0.0) { n = -n; }
  let light = .35 + .5 * max(dot(n, normalize(vec3f(.4, .9, .5))), 0.0) + .2 * max(dot(n, to_eye), 0.0);
  return vec4f(v.colour * light, 1.0);
}`;

const SAMPLES = 4;

/** A renderer for a canvas, or undefined if WebGPU is not available. `lost` is called when the device is lost. */
export async function webgpu(canvas, lost) {
  const adapter = await navigator.gpu?.requestAdapter();
  const device = await adapter?.requestDevice();
  if (!device) return undefined;
  const format = navigator.gpu.getPreferredCanvasFormat();
  const module = device.createShaderModule({ code: CODE });
  const three = (shaderLocation, offset = 0) => ({ shaderLocation, offset, format: "float32x3" });
  const pipeline = (entryPoint, buffers) =>
    device.createRenderPipelineAsync({
      layout: "auto",
      vertex: { module, entryPoint, buffers },
      fragment: { module, entryPoint: "shade", targets: [{ format }] },
      depthStencil: { format: "depth24plus", depthWriteEnabled: true, depthCompare: "less" },
      multisample: { count: SAMPLES },
    });
  const columns = [
    { arrayStride: 12, attributes: [three(0)] },
    { arrayStride: 12, attributes: [three(1)] },
    { arrayStride: 4, attributes: [{ shaderLocation: 2, offset: 0, format: "float32" }] },
  ];
  const pipelines = await Promise.all([
    pipeline("cloth", columns),
    pipeline("body", [{ arrayStride: 24, attributes: [three(0), three(1, 12)] }]),
  ]);
  // This comes last, because a canvas that has one kind of context cannot get another.
  const context = canvas.getContext("webgpu");
  if (!context) return undefined;
  context.configure({ device, format, alphaMode: "opaque" });
  device.lost.then(({ message }) => lost(message || "no reason given"));
  const { VERTEX, INDEX, UNIFORM, COPY_DST } = GPUBufferUsage;
  const uniform = device.createBuffer({ size: 80, usage: UNIFORM | COPY_DST });
  const groups = pipelines.map((pipeline) =>
    device.createBindGroup({
      layout: pipeline.getBindGroupLayout(0),
      entries: [{ binding: 0, resource: { buffer: uniform } }],
    }),
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
    device.createTexture({
      size: [canvas.width, canvas.height],
      sampleCount: SAMPLES,
      format,
      usage: GPUTextureUsage.RENDER_ATTACHMENT,
    });
  let indices = 0;
  return {
    name: "WebGPU",
    // Lets a test lose the device, because a real loss cannot be forced.
    lose: () => device.destroy(),
    triangles(list) {
      indices = list.length;
      write("triangles", list, INDEX);
    },
    draw({ positions, normals, strains, bodies, matrix, look, paper }) {
      if (targets[0]?.width !== canvas.width || targets[0]?.height !== canvas.height) {
        targets.forEach((texture) => texture.destroy());
        targets = [target(format), target("depth24plus")];
      }
      write("positions", positions, VERTEX);
      write("normals", normals, VERTEX);
      write("strains", strains, VERTEX);
      write("bodies", bodies, VERTEX);
      device.queue.writeBuffer(uniform, 0, new Float32Array([...matrix, ...look]));
      const encoder = device.createCommandEncoder();
      const pass = encoder.beginRenderPass({
        colorAttachments: [
          {
            view: targets[0].createView(),
            resolveTarget: context.getCurrentTexture().createView(),
            clearValue: [...paper, 1],
            loadOp: "clear",
            storeOp: "discard",
          },
        ],
        depthStencilAttachment: {
          view: targets[1].createView(),
          depthClearValue: 1,
          depthLoadOp: "clear",
          depthStoreOp: "discard",
        },
      });
      pass.setPipeline(pipelines[0]);
      pass.setBindGroup(0, groups[0]);
      ["positions", "normals", "strains"].forEach((name, slot) => pass.setVertexBuffer(slot, buffers[name]));
      pass.setIndexBuffer(buffers.triangles, "uint32");
      pass.drawIndexed(indices);
      if (bodies.length > 0) {
        pass.setPipeline(pipelines[1]);
        pass.setBindGroup(0, groups[1]);
        pass.setVertexBuffer(0, buffers.bodies);
        pass.draw(bodies.length / 6);
      }
      pass.end();
      device.queue.submit([encoder.finish()]);
    },
  };
}
