# Contact times of balls of radius RADIUS that move straight between their poses: from a CSV file t,name,x,y,z, each mover at
# its own instants. A line for each contact, by time: the seconds at which it begins and ends, and the two names.
#   awk -F, -v RADIUS=0.5 -f meetings.awk FILE
function place(name, t, at,   k, share) {
  for (k = 2; k < poses[name] && time[name, k] < t; ++k) {}
  share = (t - time[name, k - 1]) / (time[name, k] - time[name, k - 1])
  for (axis = 1; axis <= 3; ++axis) at[axis] = x[name, k - 1, axis] + share * (x[name, k, axis] - x[name, k - 1, axis])
}
function sum_of_products(u, v) { return u[1] * v[1] + u[2] * v[2] + u[3] * v[3] }
function flush_contact() {
  if (is_open) printf "%.9f %.9f %s %s\n", begin, end, first, second | "sort -g"
  is_open = 0
}
# Contacts of first and second between two instants without a new pose of either in between.
function touch(t0, t1,   a0, a1, b0, b1, start, way, a, b, c, root, low, high) {
  place(first, t0, a0); place(first, t1, a1); place(second, t0, b0); place(second, t1, b1)
  for (axis = 1; axis <= 3; ++axis) { start[axis] = b0[axis] - a0[axis]; way[axis] = b1[axis] - a1[axis] - start[axis] }
  a = sum_of_products(way, way); b = sum_of_products(start, way); c = sum_of_products(start, start) - 4 * RADIUS * RADIUS
  if (a == 0) { low = 0; high = c <= 0 ? 1 : -1 }
  else {
    root = b * b - a * c
    if (root < 0) { flush_contact(); return }
    root = sqrt(root); low = (-b - root) / a; high = (-b + root) / a
  }
  if (high < 0 || low > 1) { flush_contact(); return }
  if (low > 0) flush_contact()
  if (!is_open) { is_open = 1; begin = t0 + (low > 0 ? low : 0) * (t1 - t0) }
  end = t0 + (high < 1 ? high : 1) * (t1 - t0)
  if (high < 1) flush_contact()
}
FNR > 1 {
  if (!($2 in poses)) names[++name_count] = $2
  k = ++poses[$2]; time[$2, k] = $1
  for (axis = 1; axis <= 3; ++axis) x[$2, k, axis] = $(axis + 2)
}
END {
  for (i = 1; i < name_count; ++i) for (j = i + 1; j <= name_count; ++j) {
    first = names[i]; second = names[j]
    p = q = 2; t = 0
    while (p <= poses[first] && q <= poses[second]) {
      to = time[first, p] < time[second, q] ? time[first, p] : time[second, q]
      touch(t, to)
      if (time[first, p] == to) ++p
      if (time[second, q] == to) ++q
      t = to
    }
    flush_contact()
  }
}
