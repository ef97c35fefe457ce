/// Occupied cells as few boxes: from each cell on, one grows along x, then y, then z, over cells that no other one has; as the
/// server does. size: cells along each axis; occupied: bit i + size[0] * (j + size[1] * k). Calls take(low [3], cells [3]). Throws
/// where there are more cells than a server takes, or not as many bits.
function voxelBoxes(size, occupied, take) {
  const most = 256;
  if (size.some((count) => !(count >= 1 && count <= most)) || occupied.length !== Math.ceil((size[0] * size[1] * size[2]) / 8)) throw new Error("these are no voxels");
  const left = occupied.slice();
  const bitOf = ([x, y, z]) => x + size[0] * (y + size[1] * z);
  const isLeft = (at) => (left[at >> 3] >> (at & 7)) & 1;
  const every = (low, cells, test) => {
    for (let z = 0; z < cells[2]; ++z) for (let y = 0; y < cells[1]; ++y) for (let x = 0; x < cells[0]; ++x) if (!test(bitOf([low[0] + x, low[1] + y, low[2] + z]))) return false;
    return true;
  };
  const all = size[0] * size[1] * size[2];
  for (let at = 0; at < all; ++at) {
    if (!isLeft(at)) continue;
    const low = [at % size[0], Math.floor(at / size[0]) % size[1], Math.floor(at / size[0] / size[1])];
    const cells = [1, 1, 1];
    for (let axis = 0; axis < 3; ++axis) {
      while (low[axis] + cells[axis] < size[axis]) {
        const next = [...low];
        const slice = [...cells];
        next[axis] += cells[axis];
        slice[axis] = 1;
        if (!every(next, slice, isLeft)) break;
        ++cells[axis];
      }
    }
    every(low, cells, (bit) => {
      left[bit >> 3] &= ~(1 << (bit & 7));
      return true;
    });
    take(low, cells);
  }
}
