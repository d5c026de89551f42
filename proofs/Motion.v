(* Motions with piecewise continuous inputs: what stays within a bound, what is stored, what is unique. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

(* --- functions of time on an interval -------------------------------------------------------------------------- *)

(* A function that is continuous on [a, b] and whose derivative is not negative inside does not fall. *)
Lemma grows (h d : R -> R) (a b : R) : a <= b ->
  (forall t, a <= t <= b -> continuous h t) -> (forall t, a < t < b -> is_derive h t (d t)) ->
  (forall t, a < t < b -> 0 <= d t) -> h a <= h b.
Proof.
  intros Hab Hc Hd Hp.
  set (d' := fun t => if Rlt_dec a t then if Rlt_dec t b then d t else 0 else 0).
  assert (P : forall t, 0 <= d' t).
  { intros t. unfold d'. destruct (Rlt_dec a t), (Rlt_dec t b); try lra. apply Hp; lra. }
  destruct (MVT_gen h a b d') as [c [_ E]].
  - intros t Ht. rewrite Rmin_left, Rmax_right in Ht by lra. unfold d'.
    destruct (Rlt_dec a t); [|lra]. destruct (Rlt_dec t b); [|lra]. apply Hd; lra.
  - intros t Ht. rewrite Rmin_left, Rmax_right in Ht by lra.
    apply continuity_pt_filterlim. apply Hc; lra.
  - specialize (P c). nra.
Qed.

Lemma is_derive_continuous (h : R -> R) x l : is_derive h x l -> continuous h x.
Proof. intros H. apply (@ex_derive_continuous R_AbsRing R_NormedModule). eexists. exact H. Qed.

Lemma steady (h : R -> R) (a b : R) : a <= b ->
  (forall t, a <= t <= b -> continuous h t) -> (forall t, a < t < b -> is_derive h t 0) -> h b = h a.
Proof.
  intros Hab Hc Hd. apply Rle_antisym.
  - enough (- h a <= - h b) by lra. apply (grows (fun t => - h t) (fun _ => 0)); [lra| | |intros; lra].
    + intros t Ht. apply (continuous_opp h). apply Hc; exact Ht.
    + intros t Ht. evar_last; [apply (is_derive_opp h), Hd; exact Ht|]. unfold opp; simpl; ring.
  - apply (grows h (fun _ => 0)); auto; intros; lra.
Qed.

Lemma is_derive_positive_part_squared x : is_derive (fun x => Rmax 0 x * Rmax 0 x) x (2 * Rmax 0 x).
Proof.
  apply is_derive_Reals. intros eps He. exists (mkposreal eps He). intros h Hh Hlt. simpl in Hlt.
  apply Rle_lt_trans with (Rabs h); [|exact Hlt].
  replace ((Rmax 0 (x + h) * Rmax 0 (x + h) - Rmax 0 x * Rmax 0 x) / h - 2 * Rmax 0 x)
    with ((Rmax 0 (x + h) * Rmax 0 (x + h) - Rmax 0 x * Rmax 0 x - 2 * Rmax 0 x * h) / h) by (field; exact Hh).
  unfold Rdiv. rewrite Rabs_mult, Rabs_inv.
  assert (0 < Rabs h) by (apply Rabs_pos_lt; exact Hh).
  apply Rmult_le_reg_r with (Rabs h); [lra|]. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
  rewrite <- Rabs_mult, (Rabs_pos_eq (h * h)) by nra.
  apply Rabs_le. unfold Rmax. destruct (Rle_dec 0 (x + h)), (Rle_dec 0 x); nra.
Qed.

(* Whatever does not rise while it is at B or above does not pass B. *)
Lemma below (y dy : R -> R) (a b B : R) : a <= b -> y a <= B ->
  (forall t, a <= t <= b -> continuous y t) -> (forall t, a < t < b -> is_derive y t (dy t)) ->
  (forall t, a < t < b -> B <= y t -> dy t <= 0) -> y b <= B.
Proof.
  intros Hab H0 Hc Hd Hin. set (q := fun x => Rmax 0 x * Rmax 0 x).
  assert (Q : forall x, is_derive q x (2 * Rmax 0 x)) by apply is_derive_positive_part_squared.
  assert (G : - q (y a - B) <= - q (y b - B)).
  { apply (grows (fun t => - q (y t - B)) (fun t => - (dy t * (2 * Rmax 0 (y t - B))))); auto.
    - intros t Ht. apply (continuous_opp (fun t => q (y t - B))).
      apply (continuous_comp (fun t => y t - B) q).
      + apply (continuous_minus y (fun _ => B)); [apply Hc; exact Ht|apply continuous_const].
      + exact (is_derive_continuous q _ _ (Q _)).
    - intros t Ht. apply (is_derive_opp (fun t => q (y t - B))).
      apply (is_derive_comp q (fun t => y t - B) t); [apply Q|].
      evar_last; [apply @is_derive_minus; [apply Hd; exact Ht|apply is_derive_const]|].
      unfold minus, plus, opp, zero; simpl; ring.
    - intros t Ht. destruct (Rle_lt_dec B (y t)) as [L | L].
      + pose proof (Hin t Ht L). pose proof (Rmax_l 0 (y t - B)). nra.
      + rewrite Rmax_left by lra. lra. }
  unfold q in G. rewrite (Rmax_left 0 (y a - B)) in G by lra.
  pose proof (Rmax_l 0 (y b - B)). pose proof (Rmax_r 0 (y b - B)). nra.
Qed.

(* --- motions --------------------------------------------------------------------------------------------------- *)

(* On a piece the input is that of a continuous function, and z is continuous, with the derivative f (u t) (z t) inside.
   At the ends the input may have any value. U is R for a velocity; more where the level varies. *)
Section Motion.
Context {U : UniformSpace}.
Variable f : U -> R -> R.

Definition piece (u : R -> U) (z : R -> R) (a b : R) : Prop :=
  a < b /\ exists (u' : R -> U) (z' : R -> R),
    (forall t, continuous u' t) /\ (forall t, continuous z' t) /\ (forall t, a <= t <= b -> z t = z' t) /\
    (forall t, a < t < b -> u t = u' t /\ is_derive z t (f (u t) (z t))).

Inductive motion (u : R -> U) (z : R -> R) : R -> R -> Prop :=
  | at_once a : motion u z a a
  | onward a b c : motion u z a b -> piece u z b c -> motion u z a c.

Lemma motion_of_piece u z a b : piece u z a b -> motion u z a b.
Proof. intros H. apply onward with a; [apply at_once|exact H]. Qed.

Lemma motion_le u z a b : motion u z a b -> a <= b.
Proof. induction 1 as [|a b c _ IH [H _]]; lra. Qed.

Lemma near (z z' : R -> R) (a b t l : R) : (forall t, a <= t <= b -> z t = z' t) -> a < t < b ->
  is_derive z t l -> is_derive z' t l.
Proof.
  intros E Ht. apply is_derive_ext_loc.
  apply (locally_interval _ t a b); simpl; try lra. intros s H1 H2. apply E. simpl in *; lra.
Qed.

Lemma piece_within u z a b B : piece u z a b -> Rabs (z a) <= B ->
  (forall t, a < t < b -> B <= z t -> f (u t) (z t) <= 0) ->
  (forall t, a < t < b -> z t <= - B -> 0 <= f (u t) (z t)) ->
  forall t, a <= t <= b -> Rabs (z t) <= B.
Proof.
  intros [Hab (u' & z' & _ & Hz & E & Hd)] H0 Hup Hlow t Ht.
  apply Rabs_le_between in H0. apply Rabs_le. rewrite (E t Ht), (E a) in * by lra. split.
  - enough (- z' t <= B) by lra.
    apply (below (fun t => - z' t) (fun t => - f (u t) (z t)) a); try lra.
    + intros s _. apply (continuous_opp z'). apply Hz.
    + intros s Hs. apply (is_derive_opp z'). apply (near z z' a b); auto; [lra|]. apply Hd; lra.
    + intros s Hs Hb. rewrite <- (E s) in Hb by lra. assert (0 <= f (u s) (z s)) by (apply Hlow; lra). lra.
  - apply (below z' (fun t => f (u t) (z t)) a); try lra.
    + intros s _. apply Hz.
    + intros s Hs. apply (near z z' a b); auto; [lra|]. apply Hd; lra.
    + intros s Hs Hb. rewrite <- (E s) in Hb by lra. apply Hup; lra.
Qed.

(* |z| <= B is kept where dz/dt points inward on its edges and beyond. *)
Theorem motion_within (ok : U -> Prop) (B : R) u z a b : motion u z a b ->
  (forall t, a <= t <= b -> ok (u t)) -> Rabs (z a) <= B ->
  (forall w x, ok w -> B <= x -> f w x <= 0) -> (forall w x, ok w -> x <= - B -> 0 <= f w x) ->
  forall t, a <= t <= b -> Rabs (z t) <= B.
Proof.
  intros M Hok H0 Hup Hlow. induction M as [a | a b c M IH P]; intros t Ht.
  - replace t with a by lra. exact H0.
  - assert (L := motion_le _ _ _ _ M). assert (Hbc : b < c) by apply P.
    assert (IH' : forall t, a <= t <= b -> Rabs (z t) <= B).
    { intros s Hs. apply IH; auto. intros r Hr. apply Hok. lra. }
    destruct (Rle_lt_dec t b) as [T | T]; [apply IH'; lra|].
    apply (piece_within u z b c); auto; [apply IH'; lra| | |lra].
    + intros s Hs. apply Hup. apply Hok. lra.
    + intros s Hs. apply Hlow. apply Hok. lra.
Qed.

(* The bound B is kept by every motion whose inputs are ok. *)
Definition keeps (ok : U -> Prop) (B : R) : Prop :=
  forall u z a b, motion u z a b -> (forall t, a <= t <= b -> ok (u t)) -> Rabs (z a) <= B ->
  forall t, a <= t <= b -> Rabs (z t) <= B.

(* --- what is stored rises by no more than what is put in ------------------------------------------------------ *)

Definition continuous_2 (h : U -> R -> R) : Prop :=
  forall w x, continuous (fun q : U * R => h (fst q) (snd q)) (w, x).

Lemma piece_power (p : U -> R -> R) u z a b : piece u z a b -> continuous_2 p ->
  exists p', (forall t, continuous p' t) /\ forall t, a < t < b -> p (u t) (z t) = p' t.
Proof.
  intros [Hab (u' & z' & Hu & Hz & E & Hd)] Hp. exists (fun t => p (u' t) (z' t)). split.
  - intros t. apply (continuous_comp_2 u' z' p); [apply Hu|apply Hz|exact (Hp _ _)].
  - intros t Ht. destruct (Hd t Ht) as [<- _]. rewrite (E t) by lra. reflexivity.
Qed.

Lemma ex_RInt_piece (p p' : R -> R) a b : a <= b -> (forall t, continuous p' t) ->
  (forall t, a < t < b -> p t = p' t) -> ex_RInt p a b /\ RInt p a b = RInt p' a b.
Proof.
  intros Hab Hc E.
  assert (X : forall t, Rmin a b < t < Rmax a b -> p' t = p t).
  { intros t Ht. rewrite Rmin_left, Rmax_right in Ht by lra. symmetry. apply E; exact Ht. }
  split.
  - apply (ex_RInt_ext p'); auto. apply (@ex_RInt_continuous R_CompleteNormedModule). intros t _. apply Hc.
  - symmetry. apply RInt_ext; auto.
Qed.

Lemma is_derive_integral (p' : R -> R) a t : (forall t, continuous p' t) -> is_derive (RInt p' a) t (p' t).
Proof.
  intros Hc. apply (is_derive_RInt p' (RInt p' a) a t); [|apply Hc].
  apply filter_forall. intros x. apply (@RInt_correct R_CompleteNormedModule).
  apply (@ex_RInt_continuous R_CompleteNormedModule). intros s _. apply Hc.
Qed.

Lemma piece_stores (p : U -> R -> R) (S S' : R -> R) u z a b : piece u z a b -> continuous_2 p ->
  (forall x, is_derive S x (S' x)) -> (forall t, a < t < b -> S' (z t) * f (u t) (z t) <= p (u t) (z t)) ->
  ex_RInt (fun t => p (u t) (z t)) a b /\ S (z b) - S (z a) <= RInt (fun t => p (u t) (z t)) a b.
Proof.
  intros P Hp HS HD. destruct (piece_power p u z a b P Hp) as (p' & Hc & Ep).
  destruct P as [Hab (u' & z' & _ & Hz & E & Hd)].
  destruct (ex_RInt_piece (fun t => p (u t) (z t)) p' a b) as [X ->]; auto; [lra|]. split; [exact X|].
  rewrite !E by lra.
  assert (G : RInt p' a a - S (z' a) <= RInt p' a b - S (z' b)).
  { apply (grows (fun t => RInt p' a t - S (z' t)) (fun t => p' t - S' (z' t) * f (u t) (z t))); [lra| | |].
    - intros t _. apply (continuous_minus (RInt p' a) (fun t => S (z' t))).
      + apply (is_derive_continuous _ t (p' t)). apply is_derive_integral; exact Hc.
      + apply (continuous_comp z' S); [apply Hz|]. apply (is_derive_continuous S _ _ (HS _)).
    - intros t Ht. apply (is_derive_minus (RInt p' a) (fun t => S (z' t))); [apply is_derive_integral; exact Hc|].
      evar_last; [apply (is_derive_comp S z' t); [apply HS|apply (near z z' a b); auto; apply Hd; exact Ht]|].
      unfold scal; simpl. unfold mult; simpl. ring.
    - intros t Ht. rewrite <- Ep, <- (E t) by lra. specialize (HD t Ht). lra. }
  rewrite RInt_point in G. unfold zero in G; simpl in G. lra.
Qed.

(* S is a storage function: whatever the input, S rises by no more than the integral of the power. *)
Definition storage (ok : U -> Prop) (p : U -> R -> R) (dom : R -> Prop) (S : R -> R) : Prop :=
  (forall x, dom x -> 0 <= S x) /\
  forall u z a b, motion u z a b -> (forall t, a <= t <= b -> ok (u t)) -> dom (z a) ->
    ex_RInt (fun t => p (u t) (z t)) a b /\ S (z b) - S (z a) <= RInt (fun t => p (u t) (z t)) a b.

Theorem storage_by (ok : U -> Prop) (p : U -> R -> R) (dom : R -> Prop) (S S' : R -> R) :
  (forall u z a b, motion u z a b -> (forall t, a <= t <= b -> ok (u t)) -> dom (z a) ->
     forall t, a <= t <= b -> dom (z t)) ->
  continuous_2 p -> (forall x, is_derive S x (S' x)) -> (forall x, dom x -> 0 <= S x) ->
  (forall w x, ok w -> dom x -> S' x * f w x <= p w x) -> storage ok p dom S.
Proof.
  intros Hin Hp HS H0 HD. split; [exact H0|]. intros u z a b M. induction M as [a | a b c M IH P]; intros Hok Hz.
  - split; [apply ex_RInt_point|]. rewrite RInt_point. unfold zero; simpl. lra.
  - assert (L := motion_le _ _ _ _ M). assert (Hbc : b < c) by apply P.
    destruct IH as [X1 I1]; auto; [intros t Ht; apply Hok; lra|].
    assert (W : forall t, a <= t <= c -> dom (z t)).
    { apply (Hin u z a c); auto. apply onward with b; auto. }
    destruct (piece_stores p S S' u z b c) as [X2 I2]; auto.
    { intros t Ht. apply HD; [apply Hok|apply W]; lra. }
    split; [apply (ex_RInt_Chasles _ a b c); auto|].
    rewrite <- (RInt_Chasles _ a b c) by auto. unfold plus; simpl. lra.
Qed.
End Motion.

Definition any {A : Type} (_ : A) : Prop := True.
Definition within (B z : R) : Prop := Rabs z <= B.

Lemma storage_within {U : UniformSpace} (f p : U -> R -> R) ok (dom dom' : R -> Prop) S :
  (forall x, dom' x -> dom x) -> storage f ok p dom S -> storage f ok p dom' S.
Proof. intros L [H0 H]. split; [intros x Hx; apply H0, L, Hx|]. intros u z a b M Hok Hz. apply H; auto. Qed.

(* A law of friction, from the velocity v to the force F: passive if some storage function exists. *)
Definition power_of (F : R -> R -> R) (v z : R) : R := F v z * v.
Definition passive (rate F : R -> R -> R) (dom : R -> Prop) : Prop :=
  exists S, storage (U := R_UniformSpace) rate any (power_of F) dom S.
