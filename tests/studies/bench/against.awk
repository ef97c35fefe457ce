# Two runs of deploy/bench side by side: how many times as long each row of the later one took, and its distance to the
# best peer then and now, which does not depend on how busy the machine was.
# usage: awk -f fields.awk -f against.awk BEFORE.csv NOW.csv
# A row is called slower or faster only where the ranges of the two runs do not overlap.

FNR == 1 {
  ++files
  if ($0 !~ /^scene,size,work,method,ns,ns_low,ns_high,ratio/) {
    print "bench: " FILENAME " holds no rows of deploy/bench" > "/dev/stderr"
    failed = 1
    exit 2
  }
  if (files == 2) printf "%-10s %9s %-26s %-24s %12s %12s %6s %15s\n", "scene", "size", "work", "method", "before ns", "now ns", "times", "peer/ours"
  next
}

{
  if (fields($0, row) < 8) next
  key = row[1] SUBSEP row[2] SUBSEP row[3] SUBSEP row[4]
  if (files == 1) {
    ns[key] = row[5]; low[key] = row[6]; high[key] = row[7]; ratio[key] = row[8]
    next
  }
  if (!(key in ns)) { ++new_rows; next }
  seen[key] = 1
  ++compared
  verdict = ""
  if (row[6] + 0 > high[key] + 0) { verdict = "  slower"; ++slower }
  if (row[7] + 0 < low[key] + 0) { verdict = "  faster"; ++faster }
  printf "%-10s %9s %-26s %-24s %12.1f %12.1f %6.2f %6.2f -> %5.2f%s\n", row[1], row[2], row[3], row[4], ns[key], row[5], (ns[key] > 0 ? row[5] / ns[key] : 0), ratio[key], row[8], verdict
}

END {
  if (failed) exit 2
  for (key in ns) if (!(key in seen)) ++gone
  printf "%d rows compared: %d slower, %d faster, the others within the spread of the runs; %d new, %d not run now\n", compared, slower, faster, new_rows, gone
  exit compared == 0
}
