# Poses of three carts in a yard as CSV for `collide publish`: each goes straight from corner to corner of its own path,
# posed at its own rate, so that two are posed together only by chance.
function drive(name, rate, phase, points,   corners, count, i, k, t, end, from, to, share) {
  count = split(points, corners, " ")
  end = seconds
  for (k = 0; k == 0 || t < end; ++k) {
    t = k == 0 ? 0 : phase + (k - 1) / rate
    if (t > end) t = end
    i = int(t / end * (count - 1))
    if (i > count - 2) i = count - 2
    share = t / end * (count - 1) - i
    split(corners[i + 1], from, ","); split(corners[i + 2], to, ",")
    printf "%.6f,%s,%.6f,%.6f,%.6f\n", t, name, from[1] + share * (to[1] - from[1]), from[2] + share * (to[2] - from[2]), 0.5 | "sort -s -t, -g -k1,1"
    if (k > 0 && t == end) break
  }
}
BEGIN {
  seconds = 12
  print "t,name,x,y,z"
  fflush()
  drive("tug", 50, 0.0031, "20,0 32,6 20,6 32,0 20,3")
  drive("lift", 21, 0.0173, "32,0 20,6 32,6 20,1")
  drive("pallet", 6, 0.0857, "26,-1 26,7 25,-1")
}
