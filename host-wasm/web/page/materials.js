// Materials: density, kg/m²; stiffness against stretch and shear, N/m; flexural rigidity, N m. The values are orders
// of magnitude for such cloths, not measurements of one. Stretch is softer than measured, as is usual, so that steps
// can be larger.

const of = (density, stretch, shear, rigidity) => ({
  "cloth.density": density,
  "cloth.stretch.stiffness": stretch,
  "cloth.shear.stiffness": shear,
  "cloth.bend": { model: "hinge", rigidity, damping: 0.001 },
});

export const materials = {
  silk: of(0.06, 800, 40, 2e-6),
  cotton: of(0.15, 2000, 200, 1e-5),
  denim: of(0.4, 6000, 1200, 1e-4),
  leather: of(0.9, 12000, 5000, 1e-3),
};
