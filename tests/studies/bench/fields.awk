# The fields of a line of CSV, which may be quoted: fills `into` and returns how many there are.
function fields(line, into,    i, count, character, quoted, text) {
  count = 0
  text = ""
  quoted = 0
  for (i = 1; i <= length(line); ++i) {
    character = substr(line, i, 1)
    if (character == "\"") quoted = !quoted
    else if (character == "," && !quoted) { into[++count] = text; text = "" }
    else text = text character
  }
  into[++count] = text
  return count
}
