# Rays through the ground-floor rooms of an IFC house, and how long each must be.
# Reads the IFC file, finds each IfcSpace of the lowest storey with its extruded outline, and prints for 18 points a
# room and 6 axis directions: id,fx,fy,fz,dx,dy,dz,room,expected  in the file's own frame, where z is up. The expected
# length is the distance from the point to the room's stated boundary.
function arguments(text) { sub(/^[^(]*\(/, "", text); sub(/\);[ \r]*$/, "", text); return text }
function numbers(text, out) { gsub(/[()]/, "", text); return split(text, out, ",") }
/^#[0-9]+= *IFC(CARTESIANPOINT|DIRECTION|AXIS2PLACEMENT3D|LOCALPLACEMENT|POLYLINE|ARBITRARYCLOSEDPROFILEDEF|EXTRUDEDAREASOLID|SHAPEREPRESENTATION|PRODUCTDEFINITIONSHAPE|SPACE)\(/ {
  id = $0; sub(/=.*/, "", id)
  args[id] = arguments($0)
  if ($0 ~ /IFCSPACE\(/) spaces[++space_count] = id
}
END {
  for (s = 1; s <= space_count; ++s) emit(spaces[s])
}
function emit(space,   part, name, placement, shape, list, i, storey) {
  # GlobalId, OwnerHistory, Name, Description, ObjectType, Placement, Representation, ...
  split(args[space], part, ",")
  name = part[3]; gsub(/'/, "", name)
  split(args[part[6]], placement, ",")
  storey = placement[1]
  if (first_storey == "") first_storey = storey
  if (storey != first_storey) return
  low_x = low_y = 1e300; high_x = high_y = -1e300
  outline(part[7], placement[2])
  rays(name)
}
# The outline's corners, placed by the space's own axes (IFC: location, axis z, direction x).
function outline(definition, axes,   list, n, solid, extrude, profile, points, axis, at, x_axis, i, p, ux, uy) {
  n = split(args[definition], list, ","); solid = list[n]; gsub(/[()]/, "", solid)
  n = split(args[solid], list, ","); solid = list[n]; gsub(/[()]/, "", solid)
  split(args[solid], extrude, ",")
  height = extrude[4]
  split(args[extrude[1]], profile, ",")
  split(args[axes], axis, ",")
  numbers(args[axis[1]], at)
  ux = 1; uy = 0
  if (axis[3] != "$") { numbers(args[axis[3]], x_axis); ux = x_axis[1]; uy = x_axis[2] }
  points = args[profile[3]]; gsub(/[()]/, "", points)
  n = split(points, list, ",")
  for (i = 1; i <= n; ++i) {
    numbers(args[list[i]], p)
    grow(at[1] + p[1] * ux - p[2] * uy, at[2] + p[1] * uy + p[2] * ux)
  }
  floor_z = at[3]
}
function grow(x, y) {
  if (x < low_x) low_x = x
  if (x > high_x) high_x = x
  if (y < low_y) low_y = y
  if (y > high_y) high_y = y
}
function rays(name,   i, j, k, x, y, z) {
  for (i = 1; i <= 3; ++i) for (j = 1; j <= 3; ++j) for (k = 1; k <= 2; ++k) {
    x = low_x + (high_x - low_x) * i / 4
    y = low_y + (high_y - low_y) * j / 4
    z = floor_z + (k == 1 ? height / 2 : height - 0.2)
    ray(name, x, y, z,  1, 0, 0, high_x - x)
    ray(name, x, y, z, -1, 0, 0, x - low_x)
    ray(name, x, y, z, 0,  1, 0, high_y - y)
    ray(name, x, y, z, 0, -1, 0, y - low_y)
    ray(name, x, y, z, 0, 0,  1, floor_z + height - z)
    ray(name, x, y, z, 0, 0, -1, z - floor_z)
  }
}
function ray(name, x, y, z, dx, dy, dz, expected) {
  if (!header++) print "id,fx,fy,fz,dx,dy,dz,room,expected"
  printf "%d,%.5f,%.5f,%.5f,%d,%d,%d,%s,%.6f\n", ray_count++, x, y, z, dx, dy, dz, name, expected
}
