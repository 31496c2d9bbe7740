# cmake -DFROM=weights.safetensors -DTO=source.c -DNAME=variable -DHEADER=header -P weights.cmake
#
# Writes a safetensors file of single-precision arrays as C: the constant NAME of type `safetensors`, with a table of arrays
# and one of notes. So the library needs no parser for its own weights.
file(READ ${FROM} bytes HEX)
string(SUBSTRING ${bytes} 0 8 size)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1" size ${size})
math(EXPR size "${size}")
file(READ ${FROM} header OFFSET 8 LIMIT ${size})

# Arrays in the order of their data: the offset comes first in each entry, so that sorting the text sorts the arrays.
string(JSON member_count LENGTH "${header}")
math(EXPR last "${member_count} - 1")
set(entries)
set(notes)
set(note_count 0)
foreach(index RANGE ${last})
  string(JSON name MEMBER "${header}" ${index})
  if(name STREQUAL "__metadata__")
    string(JSON note_count LENGTH "${header}" ${name})
    math(EXPR last_note "${note_count} - 1")
    foreach(note RANGE ${last_note})
      string(JSON key MEMBER "${header}" ${name} ${note})
      string(JSON value GET "${header}" ${name} ${key})
      string(REGEX REPLACE "([\\\\\"])" "\\\\\\1" value "${value}")
      string(APPEND notes "    {\"${key}\", \"${value}\"},\n")
    endforeach()
    continue()
  endif()
  string(JSON type GET "${header}" ${name} dtype)
  if(NOT type STREQUAL "F32")
    message(FATAL_ERROR "${FROM}: array ${name} is of type ${type}, not F32")
  endif()
  string(JSON rank LENGTH "${header}" ${name} shape)
  set(shape)
  set(count 1)
  math(EXPR last_side "${rank} - 1")
  foreach(side RANGE ${last_side})
    string(JSON length GET "${header}" ${name} shape ${side})
    list(APPEND shape ${length})
    math(EXPR count "${count} * ${length}")
  endforeach()
  string(JSON begin GET "${header}" ${name} data_offsets 0)
  math(EXPR place "${begin} / 4")
  math(EXPR key "1000000000 + ${begin}")
  list(JOIN shape ", " shape)
  list(APPEND entries "${key}|    {.name = \"${name}\", .type = SAFETENSORS_F32, .rank = ${rank}, .shape = {${shape}}, \
.count = ${count}, .values = data.values + ${place}},\n")
endforeach()
list(SORT entries)
list(LENGTH entries array_count)
string(REGEX REPLACE "(^|;)[0-9]+\\|" "" arrays "${entries}")

math(EXPR start "(8 + ${size}) * 2")
string(SUBSTRING ${bytes} ${start} -1 elements)
string(LENGTH ${elements} word_count)
math(EXPR word_count "${word_count} / 8")
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1,\n" words ${elements})

file(WRITE ${TO} "#include \"${HEADER}\"

static _Alignas(64) const union
{
    uint32_t words[${word_count}];
    float values[${word_count}];
} data = {.words = {
${words}}};

static const safetensors_array arrays[] = {
${arrays}};
")
if(note_count GREATER 0)
  file(APPEND ${TO} "
static const safetensors_note notes[] = {
${notes}};

const safetensors ${NAME} = {arrays, ${array_count}, notes, ${note_count}, NULL};
")
else()
  file(APPEND ${TO} "
const safetensors ${NAME} = {arrays, ${array_count}, NULL, 0, NULL};
")
endif()
