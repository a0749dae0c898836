# cmake -DROOT=.. -DOUTPUT=.. -P HashOfSources.cmake: a header with the hash of all sources that decide over what is
# generated. It is written only if that has changed.
file(GLOB_RECURSE sources RELATIVE "${ROOT}" LIST_DIRECTORIES false
  "${ROOT}/core/*.cpp" "${ROOT}/core/*.h" "${ROOT}/sim/*.cpp" "${ROOT}/sim/*.h" "${ROOT}/generator/*.cpp" "${ROOT}/generator/*.h")
list(FILTER sources EXCLUDE REGEX "^core/bags/")  # reads what others recorded
list(SORT sources)
set(hashes "")
foreach(source IN LISTS sources)
  file(SHA256 "${ROOT}/${source}" hash)
  string(APPEND hashes "${hash} ${source}\n")
endforeach()
string(SHA256 hash "${hashes}")
string(SUBSTRING "${hash}" 0 12 hash)
set(text "#define RIGPROOF_GENERATOR_SOURCES \"${hash}\"\n")
set(there "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" there)
endif()
if(NOT there STREQUAL text)
  file(WRITE "${OUTPUT}" "${text}")
endif()
