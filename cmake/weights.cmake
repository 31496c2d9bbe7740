# cmake -DFROM=weights.safetensors -DTO=source.c -DHEADER=header.h -DNAME=variable -DTYPE=type -P weights.cmake
#
# Writes a file of weights as a C array. With TYPE, the elements alone, as the words of a union of that type: single-precision
# numbers, without the file's header, whose length its first 8 bytes tell. Without, all bytes of the file.
file(READ ${FROM} bytes HEX)
if(TYPE)
  string(SUBSTRING ${bytes} 0 8 size)
  string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1" size ${size})
  math(EXPR start "(8 + ${size}) * 2")
  string(SUBSTRING ${bytes} ${start} -1 elements)
  string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1,\n" words ${elements})
  set(definition "_Alignas(64) const ${TYPE} ${NAME} = {.words = {\n${words}}};\n")
else()
  string(REGEX REPLACE "(..)" "0x\\1," elements ${bytes})
  string(REGEX REPLACE "(................................................................................)" "\\1\n" elements
         "${elements}")
  set(definition "const unsigned char ${NAME}[] = {\n${elements}\n};\nconst size_t ${NAME}_size = sizeof ${NAME};\n")
endif()
file(WRITE ${TO} "#include \"${HEADER}\"\n\n${definition}")
