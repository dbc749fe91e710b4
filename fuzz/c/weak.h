/* Included before memory.c of the core: what guarded.c defines takes the place of what it defines. */
#pragma weak arena_take
#pragma weak arena_give
#pragma weak arena_release
