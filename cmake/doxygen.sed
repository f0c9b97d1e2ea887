# What Doxygen reads of a header or page: a transpose within backticks is no quotation mark, a product of vectors no end of a sentence,
# and headings have the anchors that code hosts give them.
:transpose
s/(`[^`']*)'([^`]*`)/\1′\2/
t transpose
s/ \. / · /g
s/^(#+) (.+)$/\1 \2 {#\L\2}/
:blank
s/(\{#[^} ]*) /\1-/
t blank
# Specialisations of the standard library's variables: it does not know what they specialise.
/^inline constexpr bool std::ranges::enable_/d
