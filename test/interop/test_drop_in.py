"""A program that was linked with one library runs with the other."""
import pytest

from support.driver import Driver, FLAGS, SOURCE, data_in


@pytest.mark.parametrize("linked", ["ours", "theirs"])
def test_a_program_linked_with_one_library_runs_with_the_other(linked, library, original_library,
                                                              compiler, central, stack):
    """api-behaviour 19: same soname, same names, same sizes of data."""
    if library.link_flags:
        pytest.skip("a library with sanitizers cannot be exchanged")
    first, second = (library, original_library) if linked == "ours" else (original_library, library)
    driver = stack.enter_context(Driver(compiler.program(SOURCE, first, flags=FLAGS), second))
    driver.connect(central.address)
    driver.must("define", "M", "variable", "int")
    driver.must("subscribe_data", "M")
    driver.do("is_defined", "M")
    driver.do("listen_clear", 100)
    driver.must("publish_data", "M", "int", 12)
    assert data_in(driver.listen_for(1)) == ["12"]
    assert driver.do("publish_data", "nothing", "int", 1).error == "Message_Not_Defined"
