# Completion and the manual of `program`, below `share`, where shells and man look for them.
foreach(text
    "bash-completion/completions;rigproof;completion;bash"
    "zsh/site-functions;_rigproof;completion;zsh"
    "fish/vendor_completions.d;rigproof.fish;completion;fish"
    "man/man1;rigproof.1;manual")
  list(POP_FRONT text folder file)
  file(MAKE_DIRECTORY "${share}/${folder}")
  execute_process(COMMAND "${program}" ${text} OUTPUT_FILE "${share}/${folder}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
