import { kColours } from "./colours.js";

const byId = (id) => document.getElementById(id);

/// Connects the panel's switches and its slider with a viewer, and explains the colours.
export function connectPanel(viewer) {
  for (const option of ["wireframe", "strips", "freeze", "loud"]) {
    byId(option).addEventListener("change", (event) => viewer.set(option, event.target.checked));
  }
  const showError = () => {
    viewer.pixelError = Number((2 ** Number(byId("error").value)).toPrecision(3));
    byId("errorText").textContent = `error of at most ${viewer.pixelError} px`;
  };
  byId("error").addEventListener("input", showError);
  showError();
  // As text: chunks.json may hold anything.
  viewer.index.tolerances_voxels.forEach((tolerance, level) => {
    const entry = document.createElement("span");
    entry.className = "entry";
    const swatch = document.createElement("span");
    swatch.className = "swatch";
    swatch.style.background = kColours[level % kColours.length];
    entry.append(swatch, `${level}: ${tolerance}`);
    byId("legend").append(entry, " ");
  });
}

/// Offers the scenes by their names, if there are several. The address says which one is shown.
export function offerScenes(names, shown) {
  const menu = byId("scene");
  menu.append(...names.map((name) => new Option(name)));
  menu.value = shown;
  menu.hidden = names.length < 2;
  menu.addEventListener("change", () => {
    location.search = new URLSearchParams({ scene: menu.value });
  });
}

/// What there is to say of the present frame.
export function showFigures(text) {
  byId("figures").textContent = text;
}

/// The panel's place in the window.
export const panelBox = () => byId("panel").getBoundingClientRect();
