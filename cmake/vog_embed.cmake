# vog_embed(OUTPUT HEADER FUNCTION FILE...): a rule that makes OUTPUT, a source that gives the files as strings
# (embed_text.cmake).
set(VOG_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_text.cmake)
function(vog_embed output header function)
    add_custom_command(OUTPUT ${output}
                       COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DHEADER=${header} -DFUNCTION=${function}
                               "-DFILES=${ARGN}" -P ${VOG_EMBED_SCRIPT}
                       DEPENDS ${ARGN} ${VOG_EMBED_SCRIPT} VERBATIM)
endfunction()
