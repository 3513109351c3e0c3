// Numbers that both renderers and the page share: colours, as red, green and blue, and the shadow.

/** Blue and orange differ for all kinds of colour vision (M. Okabe, K. Ito, Color Universal Design, 2008). */
export const COLOURS = { cloth: ".85, .62, .45", body: ".5, .53, .56", stretched: ".835, .369, 0.", compressed: "0., .447, .698" };
/** Direction to the sun, and the pixels of a side of the depth map. */
export const SHADOW = { sun: ".362, .815, .453", size: 1024 };
/** Strain at which the colours saturate. */
export const STRAINED = 0.05;
