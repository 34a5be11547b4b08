"""Where the tool is not yet as the tables say: of each row, what is wrong today. A mend deletes its line here."""

_CHECK_WORDS_IT = "check has its own words for what the core says"

TOOL = {
    "subset: inactive": "an inactive prim counts",
    "points: nan at a frame": _CHECK_WORDS_IT,
    "points: infinite at a frame": _CHECK_WORDS_IT,
}
