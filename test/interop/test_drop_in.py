"""A program that was linked with one library runs with the other."""
import pytest

from support.driver import Driver, FLAGS, SOURCE, data_in


# A program that is not position-independent holds copies of the library's data, such as IPC_errno,
# in the sizes they had when it was linked.
POSITIONS = {"pie": ["-fpie", "-pie"], "fixed": ["-fno-pie", "-no-pie"]}


@pytest.mark.parametrize("position", POSITIONS)
@pytest.mark.parametrize("linked", ["ours", "theirs"])
def test_a_program_linked_with_one_library_runs_with_the_other(
        linked, position, library, original_library, compiler, central, stack):
    """api-behaviour 19: same soname, same names, same sizes of data."""
    if library.link_flags:
        pytest.skip("a library with sanitizers cannot be exchanged")
    first, second = (library, original_library) if linked == "ours" else (original_library, library)
    program = compiler.program(SOURCE, first, name=f"driver_{position}",
                               flags=FLAGS + POSITIONS[position])
    driver = stack.enter_context(Driver(program, second))
    driver.connect(central.address, verbosity=2)
    driver.must("define", "M", "variable", "int")
    driver.must("subscribe_data", "M")
    driver.do("is_defined", "M")
    driver.do("listen_clear", 100)
    driver.must("publish_data", "M", "int", 12)
    assert data_in(driver.listen_for(1)) == ["12"]
    assert driver.do("publish_data", "nothing", "int", 1).error == "Message_Not_Defined"
    driver.wait_for_line("^ERROR: IPC message not defined$", stream="stderr")
