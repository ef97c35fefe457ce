-- Pandoc's filter for the guides of deploy/docs: to text for terminals (-t plain) and to manual pages (-t man).
local is_man = FORMAT == "man"
local columns = is_man and 66 or 80  -- of a table

-- A link to a guide says how it is opened here; one to a heading or a file is its text.
function Link(link)
  local guide = link.target:match("^([%w-]+)%.md")
  local where = guide and (is_man and "(collided-" .. guide .. "(7))" or "(collide help " .. guide .. ")")
  if link.target:match("^http") then where = "<" .. link.target .. ">" end
  return where and link.content .. { pandoc.Space(), pandoc.Str(where) } or link.content
end

function Image() return {} end

-- Text may break a line within code.
function Code(code)
  local words = pandoc.Inlines(code.text)
  return is_man and pandoc.Strong(words) or words
end

function Header(header)
  if is_man then return nil end
  local text = pandoc.utils.stringify(header)
  return pandoc.RawBlock("plain", text .. "\n" .. (header.level == 1 and "=" or "-"):rep(utf8.len(text)))
end

-- Columns as wide as their longest cell or, where those do not fit, an equal share of what the narrower ones leave. A manual
-- page has them as text, since troff warns of words that are wider than a column.
function Table(given)
  local simple = pandoc.utils.to_simple_table(given)
  local longest, order, left = {}, {}, columns - 2
  for column = 1, #simple.widths do
    order[column], longest[column] = column, 0
    for _, row in ipairs({ simple.header, table.unpack(simple.rows) }) do
      longest[column] = math.max(longest[column], utf8.len(pandoc.utils.stringify(row[column])) + 2)
    end
  end
  table.sort(order, function(a, b) return longest[a] < longest[b] end)
  for rank, column in ipairs(order) do
    local width = math.min(longest[column], left // (#order - rank + 1))
    simple.widths[column], left = width / columns, left - width
  end
  local made = pandoc.utils.from_simple_table(simple)
  return is_man and pandoc.CodeBlock(pandoc.write(pandoc.Pandoc({ made }), "plain", { columns = columns })) or made
end

-- The page of a guide has its name and purpose first: "You want to know what a ray meets." is there for that.
function Pandoc(guide)
  local purpose = pandoc.utils.stringify(guide.blocks[2]):match("^You want ([^.]*)")
  if not is_man or not purpose then return nil end
  local title = pandoc.utils.stringify(guide.meta.title)
  local blocks = { pandoc.Header(1, "NAME"), pandoc.Para(title .. " - " .. purpose), pandoc.Header(1, "DESCRIPTION") }
  for at = 2, #guide.blocks do
    local block = guide.blocks[at]
    if block.t == "Header" then block.level = block.level - 1 end
    table.insert(blocks, block)
  end
  table.insert(blocks, pandoc.Header(1, "SEE ALSO"))
  table.insert(blocks, pandoc.Para("collide(1), collided(1)"))
  return pandoc.Pandoc(blocks, guide.meta)
end
