# Completion and the manual of `texts_by`, below `texts_below`, where shells and man look for them.
foreach(text
    "bash-completion/completions;rigproof;completion;bash"
    "zsh/site-functions;_rigproof;completion;zsh"
    "fish/vendor_completions.d;rigproof.fish;completion;fish"
    "man/man1;rigproof.1;manual")
  list(POP_FRONT text folder file)
  file(MAKE_DIRECTORY "${texts_below}/${folder}")
  execute_process(COMMAND "${texts_by}" ${text} OUTPUT_FILE "${texts_below}/${folder}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
find_program(gzip gzip)
if(gzip)
  execute_process(COMMAND ${gzip} -9nf "${texts_below}/man/man1/rigproof.1" COMMAND_ERROR_IS_FATAL ANY)
endif()
