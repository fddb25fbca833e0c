/// Colours of the levels, from the finest on; after the last, from the first again.
export const kColours = [
  "#3f8f5f", "#c2a83e", "#4f86c6", "#cf6a3c", "#8a8f98", "#5fb3a8", "#a3502e",
];
