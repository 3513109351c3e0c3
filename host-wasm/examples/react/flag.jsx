// Muslin and React Three Fiber: a component that simulates a flag, and a slider for its wind.
// The inlined module needs no setting of the bundler. Copy the folder into your project, then:
//     npm install react react-dom three @react-three/fiber esbuild
//     npx esbuild flag.jsx --bundle --format=esm --jsx=automatic --outfile=flag.js && npx serve .

import { Canvas, useFrame } from "@react-three/fiber";
import { Cloth, load } from "muslin/inline";
import { use, useEffect, useMemo, useRef, useState } from "react";
import { createRoot } from "react-dom/client";
import { DoubleSide } from "three";

const loaded = load();

function Flag({ wind }) {
  use(loaded);
  const geometry = useRef(null);
  const [cloth, setCloth] = useState(null);

  // The cloth lives as long as the component. In strict mode it is made twice.
  useEffect(() => {
    const made = new Cloth("flag");
    made.set({ "cloth.grid.cells": [24, 19], "integrator.error": 0.004 });
    setCloth(made);
    window.cloth = made;
    return () => made.free();
  }, []);

  // A change of the wind builds nothing anew.
  useEffect(() => cloth?.wind([wind, 1, 2]), [cloth, wind]);

  const start = useMemo(
    () => cloth && { positions: cloth.positions().slice(), normals: cloth.normals().slice(), triangles: cloth.triangles().slice() },
    [cloth],
  );

  useFrame((_, passed) => {
    if (!cloth || !geometry.current) return;
    cloth.advance(Math.min(0.1, passed), { budget: 10 });
    const { position, normal } = geometry.current.attributes;
    position.copyArray(cloth.positions()).needsUpdate = true;
    normal.copyArray(cloth.normals()).needsUpdate = true;
  });

  if (!start) return null;
  return (
    <mesh frustumCulled={false}>
      <bufferGeometry ref={geometry}>
        <bufferAttribute attach="attributes-position" args={[start.positions, 3]} />
        <bufferAttribute attach="attributes-normal" args={[start.normals, 3]} />
        <bufferAttribute attach="index" args={[start.triangles, 1]} />
      </bufferGeometry>
      <meshStandardMaterial color="#d9a074" side={DoubleSide} />
    </mesh>
  );
}

function App() {
  const [wind, setWind] = useState(8);
  return (
    <>
      <Canvas camera={{ position: [0, 1.5, 3.5], rotation: [0, 0, 0], fov: 40 }}>
        <hemisphereLight args={["#ffffff", "#556677", 2]} />
        <directionalLight position={[2, 3, 4]} />
        <Flag wind={wind} />
      </Canvas>
      <label style={{ position: "fixed", top: 12, left: 12 }}>
        wind, m/s <input type="range" min="0" max="15" value={wind} onChange={({ target }) => setWind(Number(target.value))} />
      </label>
    </>
  );
}

createRoot(document.getElementById("root")).render(<App />);
