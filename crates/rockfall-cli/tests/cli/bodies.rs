//! Rigid bodies on the command line.

use super::common::Rockfall;

/// Two bodies that nothing acts on.
const SCENE: &str = "set gravity 0\n@body ball mass=5\nS 0 0 0 0 0 0 0 0 0 0 - 1\n@end\n@place ball at=1,2,3 name=first\n\
                     @place ball at=5,0,0 orientation=0.6,0,0.8,0 velocity=0,-1,0 momentum=0,2,0\n";
const HEADER: &str = "body,name,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz\n";

#[test]
fn bodies_of_the_final_state_and_of_every_state_are_written() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --steps 0 --bodies a.csv", 0);
    let lines = ["0,first,1,2,3,0,0,0,1,0,0,0,0,0,0\n", "1,,5,0,0,0,-1,0,0.6,0,0.8,0,0,2,0\n"];
    assert_eq!(rockfall.read("a.csv"), format!("{HEADER}{}{}", lines[0], lines[1]));
    rockfall.run("run scene.txt --backend cpu --dt 0.25 --steps 4 --every 2 --bodies b.csv --checkpoint a.ckpt", 0);
    let every = rockfall.read("b.csv");
    assert!(
        every.starts_with(&format!("step,time,{HEADER}0,0,{}0,0,{}2,0.5,{}2,0.5,1,,5,", lines[0], lines[1], lines[0])),
        "{every}"
    );
    assert_eq!(every.lines().count(), 7, "{every}");

    // A resumed run goes on in the same file.
    rockfall.run("run --resume a.ckpt --steps 6", 0);
    let longer = rockfall.read("b.csv");
    assert!(longer.starts_with(&every) && longer.lines().count() == every.lines().count() + 2, "{longer}");
}

#[test]
fn bodies_are_counted() {
    let rockfall = Rockfall::with(SCENE);
    let (out, _) = rockfall.run("check scene.txt", 0);
    assert!(out.contains("2 spheres, 2 rigid bodies"), "{out}");
    let (_, err) =
        Rockfall::with("S 1 0 1 0 0 0 0 0 0 0 1 0.1\n").run("run scene.txt --backend cpu --steps 1 --bodies a.csv", 0);
    assert!(err.contains("note: --bodies: the scene has no rigid bodies"), "{err}");
}
