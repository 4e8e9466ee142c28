import io

from tracked_report.terminal import coloured, render_table, visible_length


def test_columns_are_padded_to_their_widest_cell():
    text = render_table([["a", "1"], ["long name", "22"]], ["what", "n"], ["left", "right"])
    assert text.splitlines() == ["what        n", "---------  --", "a           1", "long name  22"]


def test_short_rows_and_empty_tables_are_fine():
    assert render_table([["a"], ["b", "c"]]).splitlines() == ["a", "b  c"]
    assert render_table([]) == ""


def test_colours_do_not_count_as_width():
    red = "\x1b[31mMISS\x1b[0m"
    assert visible_length(red) == 4
    assert render_table([[red, "x"], ["PASS", "y"]]).splitlines()[0] == f"{red}  x"


def test_no_colours_where_there_is_no_terminal():
    assert coloured("PASS", "green", io.StringIO()) == "PASS"
