// Where to look from at first: as near as all of it is in sight, whatever its shape and the window's.

const kMargin = 24; // pixels that stay free around what is seen

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/// What must hold along one axis of the window, so that all points are seen between the tangents `low`
/// and `high`: a distance of at least `distance`, and a place in the middle of what is then allowed.
function spanOf(points, axis, back, low, high) {
  let above = -Infinity;
  let below = Infinity;
  for (const point of points) {
    const along = dot(point, axis);
    const towards = dot(point, back);
    above = Math.max(above, along + high * towards);
    below = Math.min(below, along + low * towards);
  }
  return {
    distance: (above - below) / (high - low),
    placeAt: (distance) => (above + below - (high + low) * distance) / 2,
  };
}

/// The nearest eye of a camera that sees all points within a part of its window. `axes`: the camera's
/// right, up and back as unit vectors; `part`: { left, right, bottom, top } as tangents of the angles
/// from the camera's axis. With the eye comes how far back it is.
export function eyeThatSees(points, [right, up, back], part) {
  const across = spanOf(points, right, back, part.left, part.right);
  const upright = spanOf(points, up, back, part.bottom, part.top);
  const distance = Math.max(across.distance, upright.distance);
  const [x, y] = [across.placeAt(distance), upright.placeAt(distance)];
  const eye = [0, 1, 2].map((i) => x * right[i] + y * up[i] + distance * back[i]);
  return { eye, distance };
}

/// The parts of a window, in pixels, that the panel in its upper left corner leaves free: beside it
/// and below it. Where it leaves little, the whole window.
function freeParts({ width, height, panel }) {
  const whole = {
    left: kMargin,
    right: width - kMargin,
    top: kMargin,
    bottom: height - kMargin,
  };
  const parts = [
    { ...whole, left: panel.right + kMargin },
    { ...whole, top: panel.bottom + kMargin },
  ].filter((part) => part.right - part.left > width / 3 && part.bottom - part.top > height / 3);
  return parts.length > 0 ? parts : [whole];
}

/// The eye for a camera with this tangent of half its vertical angle, in that free part of the window
/// that shows all points largest.
export function startEye(points, axes, tangent, window) {
  const across = (x) => ((2 * x - window.width) / window.height) * tangent;
  const upright = (y) => (1 - (2 * y) / window.height) * tangent;
  const views = freeParts(window).map(({ left, right, bottom, top }) =>
    eyeThatSees(points, axes, {
      left: across(left),
      right: across(right),
      bottom: upright(bottom),
      top: upright(top),
    }),
  );
  return views.reduce((a, b) => (b.distance < a.distance ? b : a)).eye;
}
