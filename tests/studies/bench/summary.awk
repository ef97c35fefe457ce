# What the rows of one run of deploy/bench come to: for each kind of work the number of our rows, the geometric means of their
# time and of the best peer's time over ours; 0: no row has a peer.
# usage: awk -v machine=NAME -v commit=NAME -v form=quick|whole -f fields.awk -f summary.awk ROWS.csv

FNR == 1 { next }
{
  fields($0, row)
  if (row[4] != "collided") next
  work = row[3]
  if (!(work in rows)) order[++kinds] = work
  ++rows[work]
  time[work] += log(row[5])
  if (row[8] > 0) {
    ratio[work] += log(row[8])
    ++with_peer[work]
  }
}
END {
  for (i = 1; i <= kinds; ++i) {
    work = order[i]
    printf "%s,%s,%s,\"%s\",%d,%.4g,%.3g\n", machine, commit, form, work, rows[work], exp(time[work] / rows[work]),
      with_peer[work] ? exp(ratio[work] / with_peer[work]) : 0
  }
}
